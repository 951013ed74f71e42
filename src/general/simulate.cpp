#include "../kernel/simulate.hpp"

#include "../kernel/entries.hpp"
#include "../kernel/members.hpp"
#include "drives.hpp"
#include "verbs.hpp"

namespace strainwave::general {

namespace {

using Entries = kernel::Entries<Drives>;

}  // namespace

// Derivatives are in a source of their own, so that both compile side by side.
decltype(kernel::Table::differentiate) differentiate_entry();
decltype(kernel::Table::inverse_dynamics) inverse_dynamics_entry();

const kernel::Table table{1,
                          &Entries::simulate,
                          &Entries::simulate_adaptively,
                          &Entries::run_members<double>,
                          differentiate_entry(),
                          inverse_dynamics_entry()};

}  // namespace strainwave::general
