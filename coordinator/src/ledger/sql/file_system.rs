//! Whether a file is on a network file system, where SQLite's locks and syncs cannot be relied on.

use std::path::Path;

/// Kinds of file systems that are reached through a network, as the kernel names them.
const NETWORK: [&str; 12] = [
    "nfs",
    "nfs4",
    "cifs",
    "smb3",
    "smbfs",
    "ncpfs",
    "afs",
    "9p",
    "lustre",
    "beegfs",
    "gpfs",
    "fuse.sshfs",
];

/// The kind of network file system that a file is or will be on; `None` for a local one, and
/// where the kernel does not tell.
pub fn network_file_system(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
    let mounts = std::fs::read_to_string("/proc/self/mounts").ok()?;
    kind_in(&mounts, &folder)
}

/// Kind of network file system from a list of mounts: the longest mount point that the folder is below counts, and of
/// equal ones the last.
fn kind_in(mounts: &str, folder: &Path) -> Option<String> {
    let mut best: Option<(usize, &str)> = None;
    for line in mounts.lines() {
        let mut words = line.split(' ').skip(1);
        let (Some(point), Some(kind)) = (words.next(), words.next()) else {
            continue;
        };
        // A space in a name is written so.
        let point = point.replace("\\040", " ");
        if folder.starts_with(&point) && best.is_none_or(|(length, _)| point.len() >= length) {
            best = Some((point.len(), kind));
        }
    }
    best.map(|(_, kind)| kind)
        .filter(|kind| NETWORK.contains(kind))
        .map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_mount_point_counts() {
        let mounts = "/dev/sda1 / ext4 rw 0 0\n\
            server:/home /home nfs4 rw 0 0\n\
            /dev/sdb1 /home/ann/local\\040disk ext4 rw 0 0\n\
            nonsense\n";
        let kind = |path: &str| kind_in(mounts, Path::new(path));
        assert_eq!(kind("/var/lib"), None);
        assert_eq!(kind("/home/ann").as_deref(), Some("nfs4"));
        assert_eq!(kind("/homestead"), None);
        assert_eq!(kind("/home/ann/local disk/x"), None);
    }
}
