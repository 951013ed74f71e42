#pragma once
#include <strainwave/array.hpp>
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::load {

template <class S>
struct TorqueTable {
    static constexpr int capacity = 32;

    S inertia{0.01};
    Sequence<S, capacity> angle{};
    Sequence<S, capacity> held_torque{};

    static constexpr auto name = "torque_table";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Load torque over the output angle, as a table.

        .. math:: T_{load} = T_k + (T_{k+1} - T_k) \frac{\theta_{out} - \theta_k}{\theta_{k+1} - \theta_k}, \qquad
                  \theta_k \le \theta_{out} < \theta_{k+1}

        with theta_k = angle, increasing, T_k = held_torque, up to 32 of each. Before the first and after the last angle the
        torque is constant. The run's input load_torque adds a torque over time: a table over time is a scenario.

        >>> from strainwave.loads import TorqueTable
        >>> TorqueTable(angle=[-1.0, 0.0, 1.0], held_torque=[-3.0, 0.0, 5.0]).held_torque[2]
        5.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Inertia about the output axis", smallest));
        visit(SW_FIELD(m, angle, "rad", "Output angles, increasing"));
        visit(SW_FIELD(m, held_torque, "N.m", "Torque at each angle that holds the output back"));
    }

    constexpr const char* problem() const {
        if (angle.count != held_torque.count) return "angle and held_torque must have equally many elements";
        for (int k = 1; k < angle.count; ++k)
            if (!all(angle[k] > angle[k - 1])) return "angle must increase";
        return nullptr;
    }

    constexpr S torque(const S& at, const S&) const {
        if (angle.count == 0) return S(0.0);
        S sum = held_torque[0];
        for (int k = 0; k + 1 < angle.count; ++k) {
            const S width = angle[k + 1] - angle[k], share = clip((at - angle[k]) / width, S(0.0), S(1.0));
            sum = sum + share * (held_torque[k + 1] - held_torque[k]);
        }
        return sum;
    }
    constexpr S steepest() const {
        S largest{0.0};
        for (int k = 0; k + 1 < angle.count; ++k)
            largest = max(largest, abs((held_torque[k + 1] - held_torque[k]) / (angle[k + 1] - angle[k])));
        return largest;
    }
};

}  // namespace strainwave::load
