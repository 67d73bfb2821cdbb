/// How much memory this process may use.
#pragma once

#include <filesystem>

namespace servomill::sim::system {

/// Bytes that this process may use: those of the machine, or fewer where the shell (ulimit -v), a
/// container or a job allows less.
double memory_of_process();

/// Bytes that this process holds; 0 where the system does not tell.
double resident_memory();

/// Lets blocks of more than 4 MB go back to the system as soon as they are freed: left to itself,
/// the library keeps what was once freed of a long text for smaller blocks. Up to 64 MB of smaller
/// blocks stay: each point of a sweep would return its memory and take it again.
void return_large_blocks();

/// Bytes that the control groups of a process allow, of version 1 and 2, from its own group up to
/// the root; infinite where none sets a limit.
/// @param groups  the file that lists them (/proc/PID/cgroup)
/// @param root    where the groups are mounted (/sys/fs/cgroup)
double memory_of_groups(const std::filesystem::path& groups, const std::filesystem::path& root);

}  // namespace servomill::sim::system
