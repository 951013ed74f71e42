#pragma once
#include <strainwave/field.hpp>

/// The numbers of a state, and of what a drive shows of itself, one after the other. A part that chooses its law at run time has
/// room for any; its law uses some of that.
namespace strainwave::kernel {

/// Indices of slots of a part, in order.
struct Places {
    static constexpr int capacity = 240;
    int slot[capacity];
    int count = 0;

    void add(int place) { slot[count++] = place; }
};

/// Room for the numbers of a law chosen at run time.
template <class T>
concept Slots = requires(T& storage) { storage.slot; };

/// Calls number(scalar) for each number of a state that the laws of the drive use.
template <class Drive, class Number>
struct StateWalk {
    const Drive& drive;
    const Number& number;
    const char* group = "";
    bool discrete = false;

    template <class T>
    void operator()(T& member, const Field& field) const {
        if constexpr (Slots<T>) {
            const Places found = places(field.name);
            for (int i = 0; i < found.count; ++i) number(member.slot[found.slot[i]]);
        } else if constexpr (Described<T>) {
            const bool is_part = !same(field.name, "continuous") && !same(field.name, "discrete");
            T::fields(member, StateWalk{drive, number, is_part ? field.name : "", discrete || same(field.name, "discrete")});
        } else if constexpr (requires { member.item; }) {
            for (int i = 0; i < member.size(); ++i) number(member[i]);
        } else {
            number(member);
        }
    }

private:
    Places places(const char* name) const {
        Places found;
        drive.stateful_parts([&](const char* part, const auto& law) {
            if (!is_at(part, name)) return;
            if constexpr (requires { law.discrete_places(found); })
                if (discrete) return law.discrete_places(found);
            if constexpr (requires { law.places(found); }) law.places(found);
        });
        return found;
    }
    /// True for the part at `group`.`name`.
    bool is_at(const char* part, const char* name) const {
        const char* rest = part;
        for (const char* letter = group; *letter != 0; ++letter, ++rest)
            if (*rest != *letter) return false;
        return same(*group != 0 && *rest == '.' ? rest + 1 : rest, name);
    }
};

template <class Drive, class State, class Number>
void each_number(const Drive& drive, State& state, const Number& number) {
    State::fields(state, StateWalk<Drive, Number>{drive, number});
}

/// The state of a drive that has these numbers.
template <class Drive, class S>
typename Drive::State state_of(const Drive& drive, const S* numbers) {
    typename Drive::State state = drive.initial_state();
    each_number(drive, state, [&](S& x) { x = *numbers++; });
    return state;
}
/// Writes the numbers of a state; returns their end.
template <class Drive, class S>
S* write(const Drive& drive, const typename Drive::State& state, S* numbers) {
    each_number(drive, state, [&](const S& x) { *numbers++ = x; });
    return numbers;
}

/// Places of the outputs of its laws among all outputs that a drive of this type can have.
template <class Drive>
Places outputs_of(const Drive& drive) {
    using Output = typename Drive::Output;
    using S = decltype(drive.gear.damping);
    static_assert(size_of<S, Output> <= Places::capacity, "a drive shows more numbers than Places has room for");
    Places found;
    int place = 0;
    Output output{};
    Output::fields(output, [&]<class T>(const T&, const Field& field) {
        if constexpr (Slots<T>) {
            Places within;
            drive.stateful_parts([&](const char* part, const auto& law) {
                if constexpr (requires { law.output_places(within); })
                    if (same(part, field.name)) law.output_places(within);
            });
            for (int i = 0; i < within.count; ++i) found.add(place + within.slot[i]);
            place += T::capacity;
        } else if constexpr (Described<T>) {
            for (int i = 0; i < size_of<S, T>; ++i) found.add(place++);
        } else {
            found.add(place++);
        }
    });
    return found;
}

}  // namespace strainwave::kernel
