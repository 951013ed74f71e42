#pragma once
#include <string>
#include <type_traits>
#include <vector>

#include "describe.hpp"

/// The state of a drive as the numbers that its models have, one after the other. What is continuous comes first.
namespace strainwave::host {

/// Visits the numbers of a state: number(value, part, name, element, field). `part` is the path of the part of the drive whose
/// state the number belongs to, or "" if it is the drive's own; `name` what follows it.
template <class Drive, class Number>
class StateWalk {
    const Drive& drive;
    const Number& number;
    const std::string path;

public:
    StateWalk(const Drive& drive_, const Number& number_, const std::string& path_ = "")
        : drive(drive_), number(number_), path(path_) {}

    template <class T>
    void operator()(T& member, const Field& field) const {
        if constexpr (is_storage<std::remove_const_t<T>>) {
            const std::string place = path + field.name;
            drive.stateful_parts([&](const char* part, const auto& law) {
                if (place == part) of_model(law, member, place);
            });
        } else if constexpr (Described<T>) {
            const std::string name = field.name;
            const bool is_part = name != "continuous" && name != "discrete";
            T::fields(member, StateWalk(drive, number, is_part ? path + name + "." : path));
        } else {
            number(member, "", field.name, -1, field);
        }
    }

private:
    template <class Law, class S, int n, Holds what, int few>
    void of_model(const Law& law, const Storage<S, n, what, few>& slots, const std::string& part) const {
        of_model<what>(law, slots.slot, part);
    }
    template <class Law, class S, int n, Holds what, int few>
    void of_model(const Law& law, Storage<S, n, what, few>& slots, const std::string& part) const {
        of_model<what>(law, slots.slot, part);
    }
    template <Holds what, class Law, class Slot>
    void of_model(const Law& law, Slot& slot, const std::string& part) const {
        if constexpr (is_choice<Law>) {
            law.visit([&](const auto& chosen) { of_model<what>(chosen, slot, part); });
        } else if constexpr (friction::Modulation<Law>) {
            of_model<what>(law.law, slot, part);
        } else {
            // Law and slots are found by their names; those that do not fit are of different parts.
            using X = strainwave::detail::KeptIn<what, std::remove_cvref_t<decltype(slot[0])>, Law>;
            if constexpr (size_of<std::remove_cvref_t<decltype(slot[0])>, X> <= int(sizeof slot.item / sizeof slot.item[0])) {
                int i = 0;
                each<what>(law, slot, i, part, "");
            }
        }
    }
    /// The numbers of a law, of which storage hold those from number `i` on.
    template <Holds what, class Law, class Slot>
    void each(const Law& law, Slot& slot, int& i, const std::string& part, const std::string& before) const {
        using X = strainwave::detail::KeptIn<what, std::remove_cvref_t<decltype(slot[0])>, Law>;
        X names{};
        X::fields(names, [&]<class T>(const T& member, const Field& field) {
            if constexpr (is_storage<T>) {  // of the law that this one holds: as many numbers as there is room for
                const int first = i;
                each_of_inner<T>(law, slot, i, part, before + field.name + ".");
                i = first + member.slot.size();
            } else if constexpr (is_array<T>) {
                for (int k = 0; k < member.size(); ++k) number(slot[i++], part, before + field.name, k, field);
            } else {
                number(slot[i++], part, before + field.name, -1, field);
            }
        });
    }
    /// The same of the law that a law holds. It depends on `Kept`, or clang would check `law.law` of laws that hold none.
    template <class Kept, class Law, class Slot>
    void each_of_inner(const Law& law, Slot& slot, int& i, const std::string& part, const std::string& before) const {
        law.law.visit([&](const auto& inner) { each<Holds::state>(inner, slot, i, part, before); });
    }
};

template <class Drive, class State, class Number>
void each_number(const Drive& drive, State& state, const Number& number) {
    const StateWalk<Drive, Number> walk(drive, number);
    std::remove_const_t<State>::fields(state, walk);
}

/// The numbers of a state, or of what is continuous of it.
template <class Drive, class State>
auto numbers_of(const Drive& drive, const State& state) {
    using S = std::remove_const_t<std::remove_reference_t<decltype(drive.gear.damping)>>;
    std::vector<S> numbers;
    each_number(drive, state, [&](const S& x, const std::string&, const std::string&, int, const Field&) { numbers.push_back(x); });
    return numbers;
}

/// The state of a drive that has these numbers, number(i) being the i-th.
template <class Drive, class Number>
typename Drive::State state_of(const Drive& drive, const Number& number) {
    typename Drive::State state = drive.initial_state();
    int i = 0;
    each_number(drive, state, [&](auto& x, const std::string&, const std::string&, int, const Field&) { x = number(i++); });
    return state;
}

}  // namespace strainwave::host
