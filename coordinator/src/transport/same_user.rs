//! Same user: finds the user of the process at the other end of a connection over loopback.
//!
//! Linux lists the sockets of this machine with their owners in `/proc/net/tcp` and `/proc/net/tcp6` (proc(5)). The
//! other end of a connection that stands is one of them, and nobody else can have its pair of addresses.

use std::net::{IpAddr, Ipv6Addr, SocketAddr};

/// State of a socket whose connection stands (`TCP_ESTABLISHED`). One that is closing may be listed as nobody's,
/// which is root's.
const ESTABLISHED: &str = "01";

/// The user of the process that has connected from `peer` to `local`; `None` where it cannot be found out.
pub fn user_of(peer: SocketAddr, local: SocketAddr) -> Option<u32> {
    let table = |name: &str| std::fs::read_to_string(format!("/proc/net/{name}")).ok();
    let find = |table: String, peer: SocketAddr, local: SocketAddr| {
        let (peer, local) = (listed(peer), listed(local));
        table.lines().find_map(|line| user_in(line, &peer, &local))
    };
    let narrow = || find(table("tcp")?, peer, local);
    // A socket of IPv6 may speak IPv4.
    let wide = || find(table("tcp6")?, mapped(peer), mapped(local));
    narrow().or_else(wide)
}

/// The owner in a line, if it is of the connection from `local` to `remote`.
fn user_in(line: &str, local: &str, remote: &str) -> Option<u32> {
    let fields: Vec<&str> = line.split_whitespace().collect();
    match fields.as_slice() {
        [_, from, to, state, _, _, _, user, ..]
            if *from == local && *to == remote && *state == ESTABLISHED =>
        {
            user.parse().ok()
        }
        _ => None,
    }
}

/// Address mapped to IPv6.
fn mapped(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(ip) => ip.to_ipv6_mapped(),
        IpAddr::V6(ip) => ip,
    };
    SocketAddr::new(IpAddr::V6(ip), address.port())
}

/// Address as in the tables: words of 32 bits in the machine's order, hexadecimal.
fn listed(address: SocketAddr) -> String {
    let word = |bytes: &[u8]| {
        let bytes = bytes.first_chunk::<4>().copied().unwrap_or_default();
        format!("{:08X}", u32::from_ne_bytes(bytes))
    };
    let words: String = match address.ip() {
        IpAddr::V4(ip) => word(&ip.octets()),
        IpAddr::V6(ip) => Ipv6Addr::octets(&ip).chunks(4).map(word).collect(),
    };
    format!("{words}:{:04X}", address.port())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::{TcpListener, TcpStream};

    #[test]
    fn the_other_end_of_a_connection_has_an_owner() {
        let user = rustix::process::getuid().as_raw();
        for address in ["127.0.0.1:0", "[::1]:0"] {
            let Ok(listener) = TcpListener::bind(address) else {
                continue; // no IPv6 here
            };
            let server_address = listener.local_addr().unwrap();
            let client = TcpStream::connect(server_address).unwrap();
            let (_accepted, peer) = listener.accept().unwrap();
            assert_eq!(user_of(peer, server_address), Some(user), "{address}");
            assert_eq!(
                user_of(server_address, peer),
                Some(user),
                "{address}: both ends are ours"
            );
            let other = SocketAddr::new(peer.ip(), 1);
            assert_eq!(user_of(other, server_address), None);
            drop(client);
            assert_eq!(
                user_of(peer, server_address),
                None,
                "it is closing: nobody's"
            );
        }
    }

    #[test]
    fn lines_are_read_as_linux_writes_them() {
        let line = "   1: 0100007F:9C40 0100007F:1DE6 01 00000000:00000000 00:00000000 00000000  1000        0 5 1";
        let local = |port| SocketAddr::from(([127, 0, 0, 1], port));
        if cfg!(target_endian = "little") {
            let (from, to) = (listed(local(40000)), listed(local(7654)));
            assert_eq!(user_in(line, &from, &to), Some(1000));
            assert_eq!(user_in(line, &to, &from), None);
            let closing = line.replace(" 01 ", " 06 ");
            assert_eq!(user_in(&closing, &from, &to), None);
        }
        assert_eq!(user_in("sl local_address", "a", "b"), None);
    }
}
