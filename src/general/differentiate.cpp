#include "../kernel/differentiate.hpp"

#include "../kernel/entries.hpp"
#include "drives.hpp"
#include "hysteresis_laws.hpp"
#include "verbs.hpp"

namespace strainwave::general {

decltype(kernel::Table::differentiate) differentiate_entry() { return &kernel::Entries<Drives>::differentiate<slopes>; }
decltype(kernel::Table::inverse_dynamics) inverse_dynamics_entry() { return &kernel::Entries<Drives>::inverse_dynamics<slopes>; }

namespace {

/// The number of this value, the one that derivatives are taken by in lane `lane`; if there is no such lane, in none.
Slope seeded(double value, int lane) {
    Slope x(value);
    if (lane >= 0 && lane < slopes) x.slope[lane] = 1.0;
    return x;
}

/// f(gear) with the parameters number `first` and following as the numbers that derivatives are taken by.
template <class F>
void with_seeded_gear(const Set& set, const std::vector<int>& parameters, std::size_t first, const F& f) {
    std::vector<Slope> numbers(std::size_t(set.count));
    kernel::seed(set, parameters.data(), parameters.size(), first, numbers.data());
    with_model<GeneralGear>(set, static_cast<const Slope*>(numbers.data()), f);
}

}  // namespace

void differentiate_rates(const Set& set, const State& x, const Input& u, std::size_t n, std::size_t m, double* out,
                         double* by_number) {
    const auto inputs = flattened<double>(u);
    const int count = int(n), rows = int(n + m), columns = count + kernel::input_count;
    std::vector<Slope> numbers(std::size_t(set.count));
    kernel::seed(set, nullptr, 0, 0, numbers.data());
    Drives::with(set, static_cast<const Slope*>(numbers.data()), [&](const auto& drive) {
        const kernel::Places places = kernel::outputs_of(drive);
        for (int first = 0; first < columns; first += slopes) {
            std::vector<Slope> values;
            for (int i = 0; i < int(x.size()); ++i) values.push_back(seeded(x[std::size_t(i)], i < count ? i - first : -1));
            const auto state = kernel::state_of(drive, static_cast<const Slope*>(values.data()));
            Array<Slope, kernel::input_count> given;
            for (int i = 0; i < kernel::input_count; ++i) given[i] = seeded(inputs[i], count + i - first);
            const auto input = shaped<strainwave::Input<Slope>>(given);
            const auto write = [&](const Slope& found, int row) {
                out[row] = found.value;
                for (int p = first; p < first + slopes && p < columns; ++p) by_number[p * rows + row] = found.slope[p - first];
            };
            auto rates = state;
            rates.continuous = drive.derivatives(state, state.continuous, input).rate;
            int row = 0;
            kernel::each_number(drive, std::as_const(rates), [&](const Slope& rate) {
                if (row < count) write(rate, row++);
            });
            const auto all = kernel::shown<Slope>(drive, drive.evaluate(state, input), input);
            for (int i = 0; i < places.count; ++i) write(all[places.slot[i]], count + i);
        }
    });
}

void differentiate_loop(const Set& set, const double* twist, std::size_t n, const std::vector<int>& parameters, double* out,
                        double* by_number, const AtPoint& at_point) {
    if (n == 0) return;
    const std::size_t shift = parameters.size();
    for (std::size_t first = 0; first <= shift; first += slopes)
        with_seeded_gear(set, parameters, first, [&](const auto& gear) {
            const std::size_t last = std::min(shift + 1, first + slopes);
            with_quasi_static(gear, Slope(twist[0]), [&](auto moved) {
                const auto write = [&](std::size_t i, const Slope& torque) {
                    out[i] = torque.value;
                    for (std::size_t p = first; p < last; ++p) by_number[p * n + i] = torque.slope[p - first];
                };
                write(0, moved.torque(Slope(twist[0])));
                Slope point = seeded(0.0, int(shift - first));
                for (std::size_t i = 1; i < n; ++i) {
                    at_point(i);
                    point.value = twist[i];
                    moved.move(point);
                    write(i, moved.torque(point));
                }
            });
        });
}

void differentiate_steady(const Set& set, const Sliding& sliding, std::size_t n, const std::vector<int>& parameters, double* out,
                          double* by_number, const AtPoint& at_point) {
    for (std::size_t first = 0; first == 0 || first < parameters.size(); first += slopes)
        with_seeded_gear(set, parameters, first, [&](const auto& gear) {
            for (std::size_t i = 0; i < n; ++i) {
                at_point(i);
                const double turns = rint(sliding.angle[i] / (2.0 * pi));
                const friction::Contact<Slope> contact{Slope(sliding.speed[i]),
                                                       Slope(1.0),
                                                       {Slope(sliding.angle[i] - 2.0 * pi * turns), Slope(turns)},
                                                       Slope(sliding.load[i]),
                                                       Slope(sliding.temperature[i])};
                const Slope torque = friction::steady(gear.friction_input, contact);
                out[i] = torque.value;
                for (std::size_t p = first; p < first + slopes && p < parameters.size(); ++p)
                    by_number[p * n + i] = torque.slope[p - first];
            }
        });
}

}  // namespace strainwave::general
