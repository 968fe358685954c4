//! How much memory this process may still take: the least that the machine, the control groups
//! (containers, batch jobs) and the resource limits leave. Known on Linux only.

use std::fs;
use std::path::{Component, Path, PathBuf};

/// Limits from here on stand for none: version 1 of the control groups has no other word for it.
const UNLIMITED: u64 = 1 << 60;

/// Memory that is left, and what limits it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FreeMemory {
    /// Number of bytes.
    pub bytes: u64,
    /// What limits it.
    pub limit: MemoryLimit,
}

/// What limits memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MemoryLimit {
    /// The memory of the machine that no process uses.
    Machine,
    /// The limit of the control group in this folder.
    ControlGroup(PathBuf),
    /// A resource limit: its name, and the option of the shell's `ulimit`.
    Resource(&'static str, &'static str),
}

/// Returns the memory that this process may still take; `None` if unknown.
pub fn free() -> Option<FreeMemory> {
    free_below(Path::new("/"))
}

/// Like [`free`], with `root` for the root of the file system.
fn free_below(root: &Path) -> Option<FreeMemory> {
    let machine = kibibytes(&root.join("proc/meminfo"), "MemAvailable:")
        .map(|bytes| FreeMemory { bytes, limit: MemoryLimit::Machine });
    let all = machine.into_iter().chain(by_resources(root)).chain(by_control_groups(root));
    all.min_by_key(|free| free.bytes)
}

/// What the resource limits of this process leave.
fn by_resources(root: &Path) -> Vec<FreeMemory> {
    let limits = read(&root.join("proc/self/limits"));
    let left = |(start, used, name, option): (&str, &str, &'static str, &'static str)| {
        let line = limits.lines().find_map(|line| line.strip_prefix(start))?;
        let soft: u64 = line.split_whitespace().next()?.parse().ok()?;
        let used = kibibytes(&root.join("proc/self/status"), used)?;
        let limit = MemoryLimit::Resource(name, option);
        Some(FreeMemory { bytes: soft.saturating_sub(used), limit })
    };
    let kinds = [
        ("Max address space", "VmSize:", "address space", "-v"),
        ("Max data size", "VmData:", "data size", "-d"),
    ];
    kinds.into_iter().filter_map(left).collect()
}

/// What the control groups of this process and those around them leave, in both versions.
fn by_control_groups(root: &Path) -> Vec<FreeMemory> {
    let (groups, mounts) =
        (read(&root.join("proc/self/cgroup")), read(&root.join("proc/self/mountinfo")));
    let mounts: Vec<Mount<'_>> = mounts.lines().filter_map(Mount::of_line).collect();
    let mut found = Vec::new();
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':');
        let (Some(_), Some(controllers), Some(path)) =
            (fields.next(), fields.next(), fields.next())
        else {
            continue;
        };
        let files = match controllers {
            "" => &VERSION_2,
            list if list.split(',').any(|one| one == "memory") => &VERSION_1,
            _ => continue,
        };
        for mount in mounts.iter().filter(|mount| mount.has(files)) {
            let top = root.join(mount.point.trim_start_matches('/'));
            let group = top.join(mount.relative(Path::new(path)));
            let on_the_way = group.ancestors().take_while(|folder| folder.starts_with(&top));
            found.extend(on_the_way.filter_map(|folder| files.free(folder)));
        }
    }
    found
}

/// The names of the files of a control group.
struct GroupFiles {
    file_system: &'static str,
    /// The controller among the options of the mount.
    option: &'static str,
    limit: &'static str,
    used: &'static str,
    /// Names in `memory.stat` of the cache, which makes room for a process that needs it.
    cache: [&'static str; 2],
}

const VERSION_1: GroupFiles = GroupFiles {
    file_system: "cgroup",
    option: "memory",
    limit: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    cache: ["total_inactive_file ", "total_active_file "],
};

const VERSION_2: GroupFiles = GroupFiles {
    file_system: "cgroup2",
    option: "",
    limit: "memory.max",
    used: "memory.current",
    cache: ["inactive_file ", "active_file "],
};

impl GroupFiles {
    /// What the limit of one group leaves, if it has one.
    fn free(&self, group: &Path) -> Option<FreeMemory> {
        let number = |name: &str| read(&group.join(name)).trim().parse::<u64>().ok();
        let limit = number(self.limit).filter(|&limit| limit < UNLIMITED)?;
        let stat = read(&group.join("memory.stat"));
        let of_stat = |name: &str| -> Option<u64> {
            stat.lines().find_map(|line| line.strip_prefix(name))?.trim().parse().ok()
        };
        let cache: u64 = self.cache.into_iter().filter_map(of_stat).sum();
        let used = number(self.used).unwrap_or(0).saturating_sub(cache);
        let limited_by = MemoryLimit::ControlGroup(group.to_path_buf());
        Some(FreeMemory { bytes: limit.saturating_sub(used), limit: limited_by })
    }
}

/// A mounted file system: a line of `mountinfo`.
struct Mount<'a> {
    /// The folder within the file system that is mounted.
    root: &'a str,
    point: &'a str,
    file_system: &'a str,
    options: &'a str,
}

impl<'a> Mount<'a> {
    fn of_line(line: &'a str) -> Option<Self> {
        let (before, after) = line.split_once(" - ")?;
        let mut before = before.split(' ').skip(3);
        let mut after = after.split(' ');
        Some(Self {
            root: before.next()?,
            point: before.next()?,
            file_system: after.next()?,
            options: after.nth(1).unwrap_or_default(),
        })
    }

    /// Returns true if the mount holds control groups of this version that limit memory.
    fn has(&self, files: &GroupFiles) -> bool {
        let has_option =
            files.option.is_empty() || self.options.split(',').any(|o| o == files.option);
        self.file_system == files.file_system && has_option
    }

    /// The path of a group below the mount. A container may see only its own group, as the root of
    /// the mount, under a path of the host.
    fn relative(&self, group: &Path) -> PathBuf {
        let below = group.strip_prefix(self.root).unwrap_or(Path::new(""));
        let is_inside = below.components().all(|one| matches!(one, Component::Normal(_)));
        if is_inside { below.to_path_buf() } else { PathBuf::new() }
    }
}

/// Reads a line such as `VmHWM:    1234 kB` and returns bytes.
pub fn kibibytes(file: &Path, key: &str) -> Option<u64> {
    let text = read(file);
    let value = text.lines().find_map(|line| line.strip_prefix(key))?;
    Some(1024 * value.split_whitespace().next()?.parse::<u64>().ok()?)
}

fn read(file: &Path) -> String {
    fs::read_to_string(file).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    /// A root of a file system with these files and a machine of 1000 MiB.
    fn root(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in [("proc/meminfo", "MemAvailable: 1024000 kB\n")].iter().chain(files) {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    #[track_caller]
    fn limited_by_group(files: &[(&str, &str)], group: &str, mebibytes: u64) {
        let root = root(files);
        let limit = MemoryLimit::ControlGroup(root.path().join(group));
        let expected = FreeMemory { bytes: mebibytes * MIB, limit };
        assert_eq!(free_below(root.path()), Some(expected));
    }

    const MOUNT_2: &str = "30 23 0:26 / /sys/fs/cgroup rw,nosuid - cgroup2 cgroup2 rw,nsdelegate\n";

    #[test]
    fn without_limits_it_is_the_memory_of_the_machine() {
        let unlimited = [
            ("proc/self/limits", "Max address space         unlimited   unlimited   bytes\n"),
            ("proc/self/cgroup", "0::/user.slice\n"),
            ("proc/self/mountinfo", MOUNT_2),
            ("sys/fs/cgroup/user.slice/memory.max", "max\n"),
            ("sys/fs/cgroup/user.slice/memory.current", "9000000\n"),
        ];
        for files in [&unlimited[..], &[]] {
            let expected = FreeMemory { bytes: 1000 * MIB, limit: MemoryLimit::Machine };
            assert_eq!(free_below(root(files).path()), Some(expected));
        }
    }

    #[test]
    fn the_least_limit_on_the_way_up_counts() {
        let files = [
            ("proc/self/cgroup", "0::/job/step\n"),
            ("proc/self/mountinfo", MOUNT_2),
            ("sys/fs/cgroup/job/step/memory.max", "max\n"),
            ("sys/fs/cgroup/job/memory.max", "524288000\n"),
            ("sys/fs/cgroup/job/memory.current", "209715200\n"),
            (
                "sys/fs/cgroup/job/memory.stat",
                "anon 1\ninactive_file 52428800\nactive_file 52428800\n",
            ),
            ("sys/fs/cgroup/memory.max", "1073741824\n"),
        ];
        limited_by_group(&files, "sys/fs/cgroup/job", 400);
    }

    #[test]
    fn groups_of_version_1_count_too_also_in_a_container() {
        let mount = |root: &str| {
            format!("36 25 0:31 {root} /sys/fs/cgroup/memory rw shared:9 - cgroup none rw,memory\n")
        };
        let [whole, own] = [mount("/"), mount("/docker/c1")];
        let files = [
            ("proc/self/cgroup", "9:cpu,cpuacct:/x\n4:memory:/slurm/job_1/step_0\n0::/\n"),
            ("proc/self/mountinfo", whole.as_str()),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n"),
            ("sys/fs/cgroup/memory/slurm/job_1/memory.limit_in_bytes", "314572800\n"),
            ("sys/fs/cgroup/memory/slurm/job_1/memory.usage_in_bytes", "104857600\n"),
            ("sys/fs/cgroup/memory/slurm/job_1/memory.stat", "total_inactive_file 52428800\n"),
            ("sys/fs/cgroup/memory/slurm/job_1/step_0/memory.limit_in_bytes", "419430400\n"),
        ];
        limited_by_group(&files, "sys/fs/cgroup/memory/slurm/job_1", 250);
        let files = [
            ("proc/self/cgroup", "4:memory:/docker/c1\n"),
            ("proc/self/mountinfo", own.as_str()),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "104857600\n"),
        ];
        limited_by_group(&files, "sys/fs/cgroup/memory", 100);
        let above = [("proc/self/cgroup", "4:memory:/../other\n"), files[1], files[2]];
        limited_by_group(&above, "sys/fs/cgroup/memory", 100);
    }

    #[test]
    fn resource_limits_count_too() {
        for (line, limit) in [
            ("Max address space  419430400 unlimited bytes\n", ("address space", "-v")),
            ("Max data size      366912307 unlimited bytes\n", ("data size", "-d")),
        ] {
            let root = root(&[
                ("proc/self/limits", line),
                ("proc/self/status", "VmSize:  102400 kB\nVmData:\t 51103 kB\n"),
            ]);
            let free = free_below(root.path()).unwrap();
            assert_eq!(free.limit, MemoryLimit::Resource(limit.0, limit.1));
            assert_eq!(free.bytes / MIB, 300, "{line}");
        }
    }
}
