//! What Linux tells of a process and of the machine.

use std::fmt;
use std::fs::read_to_string;

/// Hundredths of a second in `/proc/stat`: the kernel's unit towards programs.
const TICKS_A_SECOND: f64 = 100.0;

/// Kibibytes, written as mebibytes.
#[derive(Debug, Clone, Copy)]
pub struct Size(f64);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.0} MiB", self.0 / 1024.0)
    }
}

/// Memory of a process.
#[derive(Debug, Clone, Copy)]
pub struct Memory {
    /// What it holds now.
    pub resident: Size,
    /// The most it has held.
    pub peak: Size,
}

/// Memory of a process as it is now.
pub fn of(process: u32) -> Memory {
    let status = read_to_string(format!("/proc/{process}/status")).expect("Linux");
    let size = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name)).expect(name);
        Size(line.split_whitespace().next().and_then(|size| size.parse().ok()).expect(name))
    };
    Memory { resident: size("VmRSS:"), peak: size("VmHWM:") }
}

/// Processes that want to run, over one, five and fifteen minutes.
pub fn load_average() -> String {
    let text = read_to_string("/proc/loadavg").expect("Linux");
    text.split_whitespace().take(3).collect::<Vec<_>>().join(" ")
}

/// How long all cores together had nothing to do since the machine started.
pub fn idle_seconds() -> f64 {
    let text = read_to_string("/proc/stat").expect("Linux");
    // user, nice, system, idle, …
    let idle = text.lines().next().and_then(|line| line.split_whitespace().nth(4));
    idle.and_then(|ticks| ticks.parse::<f64>().ok()).expect("idle") / TICKS_A_SECOND
}
