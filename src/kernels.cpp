#include "kernels.hpp"

#include <map>

namespace strainwave::host {

kernel::Table& loaded_kernel(const std::vector<int>& laws) {
    static std::map<std::vector<int>, kernel::Table> all;
    return all.try_emplace(laws, kernel::Table{}).first->second;
}

void add_kernel(const std::vector<int>& laws, const kernel::Table& table) {
    kernel::Table& known = loaded_kernel(laws);
    if (table.simulate) known.simulate = table.simulate;
    if (table.simulate_adaptively) known.simulate_adaptively = table.simulate_adaptively;
    if (table.run_members) {
        known.run_members = table.run_members;
        known.lanes = table.lanes;
    }
    if (table.differentiate) known.differentiate = table.differentiate;
    if (table.inverse_dynamics) known.inverse_dynamics = table.inverse_dynamics;
}

void forget_kernels(const std::vector<int>& laws) { loaded_kernel(laws) = {}; }

}  // namespace strainwave::host
