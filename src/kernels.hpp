#pragma once
#include <vector>

#include "general/verbs.hpp"
#include "kernel/table.hpp"

/// The kernels that are loaded, by the laws of their drives. Needs Python's lock.
namespace strainwave::host {

/// The loaded functions for drives of these laws; null entries for the others.
kernel::Table loaded_kernel(const std::vector<int>& laws);

/// A kernel for drives of these laws that has an entry; the general drive if none has. A copy, because a run does not keep Python's
/// lock, and kernels may be added or forgotten meanwhile.
template <class Entry>
kernel::Table kernel_with(Entry kernel::Table::* entry, const std::vector<int>& laws) {
    const kernel::Table loaded = loaded_kernel(laws);
    return loaded.*entry ? loaded : general::table;
}

/// Adds the jobs of a kernel. It stays loaded; after `forget_kernels` the general drive runs such drives again.
void add_kernel(const std::vector<int>& laws, const kernel::Table& table);
void forget_kernels(const std::vector<int>& laws);

}  // namespace strainwave::host
