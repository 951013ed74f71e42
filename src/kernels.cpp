#include "kernels.hpp"

#include <map>

namespace strainwave::host {

namespace {

std::map<std::vector<int>, kernel::Table>& tables() {
    static std::map<std::vector<int>, kernel::Table> by_laws;
    return by_laws;
}

}  // namespace

kernel::Table loaded_kernel(const std::vector<int>& laws) {
    const auto found = tables().find(laws);
    return found == tables().end() ? kernel::Table{} : found->second;
}

void add_kernel(const std::vector<int>& laws, const kernel::Table& table) {
    kernel::Table& known = tables()[laws];
    if (table.simulate) known.simulate = table.simulate;
    if (table.simulate_adaptively) known.simulate_adaptively = table.simulate_adaptively;
    if (table.run_members) {
        known.run_members = table.run_members;
        known.lanes = table.lanes;
    }
    if (table.differentiate) known.differentiate = table.differentiate;
    if (table.inverse_dynamics) known.inverse_dynamics = table.inverse_dynamics;
}

void forget_kernels(const std::vector<int>& laws) { tables().erase(laws); }

}  // namespace strainwave::host
