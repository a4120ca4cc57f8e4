//! Machine: what this computer offers, as the worker announces it.
//!
//! Cores, instruction set, memory. A computer without fused multiply-add is
//! refused here: it would give the same bits, but far too slowly.

use cognate_numeric::lanes::dispatch::InstructionSet;

/// Resources of this computer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// The computer's name in its network, for people.
    pub host: String,
    /// Cores that this process may use (affinity and cgroup quota taken into account).
    pub cores: usize,
    /// The instruction set that chunks are tracked with.
    pub instruction_set: InstructionSet,
    /// Memory that this process may use, in bytes; `None` where it cannot be told.
    pub memory_bytes: Option<u64>,
}

/// Why a computer cannot serve as a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnfitMachine {
    /// Without it, each fused operation is a call into software.
    #[error(
        "this machine has no fused multiply-add (x86-64 with AVX2 and FMA, or AArch64, is needed): \
         it would give the same results, but many times slower; start the worker elsewhere"
    )]
    NoFusedMultiplyAdd,
}

impl Machine {
    /// Asks the operating system.
    pub fn detect() -> Self {
        let cgroup = read_number("/sys/fs/cgroup/memory.max");
        let total = total_memory(&std::fs::read_to_string("/proc/meminfo").unwrap_or_default());
        Self {
            host: read_trimmed("/proc/sys/kernel/hostname")
                .or_else(|| std::env::var("HOSTNAME").ok())
                .unwrap_or_else(|| "unknown".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            instruction_set: InstructionSet::detect(),
            memory_bytes: match (cgroup, total) {
                (Some(limit), Some(total)) => Some(limit.min(total)),
                (limit, total) => limit.or(total),
            },
        }
    }

    /// Refuses a machine that must not track.
    pub fn check(&self) -> Result<(), UnfitMachine> {
        match self.instruction_set {
            InstructionSet::Software => Err(UnfitMachine::NoFusedMultiplyAdd),
            InstructionSet::Avx512 | InstructionSet::Avx2 | InstructionSet::Neon => Ok(()),
        }
    }
}

fn read_trimmed(path: &str) -> Option<String> {
    let text = std::fs::read_to_string(path).ok()?;
    let text = text.trim();
    (!text.is_empty()).then(|| text.to_owned())
}

fn read_number(path: &str) -> Option<u64> {
    read_trimmed(path)?.parse().ok()
}

/// The line `MemTotal: N kB` of /proc/meminfo, in bytes.
fn total_memory(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|l| l.strip_prefix("MemTotal:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_machine_is_described() {
        let machine = Machine::detect();
        assert!(machine.cores >= 1);
        assert!(!machine.host.is_empty());
        assert!(machine.memory_bytes.is_none_or(|bytes| bytes > 1 << 20));
    }

    #[test]
    fn a_machine_without_fused_multiply_add_is_refused_in_words() {
        let machine = Machine {
            host: "old".to_owned(),
            cores: 4,
            instruction_set: InstructionSet::Software,
            memory_bytes: None,
        };
        let refusal = machine.check().unwrap_err().to_string();
        assert!(refusal.contains("no fused multiply-add"), "{refusal}");
        let newer = Machine {
            instruction_set: InstructionSet::Avx2,
            ..machine
        };
        assert_eq!(newer.check(), Ok(()));
    }

    #[test]
    fn total_memory_is_read_in_bytes() {
        let text = "MemTotal:       16307668 kB\nMemFree:         123 kB\n";
        assert_eq!(total_memory(text), Some(16_307_668 * 1024));
        assert_eq!(total_memory("MemTotal: lots kB"), None);
        assert_eq!(total_memory(""), None);
    }
}
