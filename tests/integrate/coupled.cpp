#include <cstdio>
#include <cstdlib>
#include <strainwave/scalar/dual.hpp>
#include <strainwave/scalar/pack.hpp>

#include "stiff_follower.hpp"

using namespace strainwave;

constexpr int size = 6;

/// Reads a matrix from the input, row by row.
bool read(integrate::Square<Array<double, size>>& z) {
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
            if (std::scanf("%lf", &z[j][i]) != 1) return false;
    return true;
}
void write(const integrate::Square<Array<double, size>>& z) {
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) std::printf("%.17g ", z[j][i]);
    std::printf("\n");
}

/// exp Z, phi_1, phi_2 and phi_3 of each matrix of the input, and whether a pack of several gives the same bits.
void phi_functions() {
    using Phi = integrate::PhiFunctions<Array<double, size>>;
    using Square = integrate::Square<Array<double, size>>;
    using Lanes = Pack<4>;
    Square z;
    while (read(z)) {
        Phi phi;
        Square given = z, room;
        phi.set(given, room);
        write(phi.exponential);
        write(phi.first);
        write(phi.second);
        write(phi.third);
        integrate::Square<Array<Lanes, size>> several, room_of_several;
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i)
                for (int lane = 0; lane < 4; ++lane) several[j][i].set(lane, z[j][i] * (lane == 1 ? 1.0 : 0.01 * lane));
        integrate::PhiFunctions<Array<Lanes, size>> packed;
        packed.set(several, room_of_several);
        int different = 0;
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i) different += packed.third[j][i][1] != phi.third[j][i];
        std::printf("%d\n", different);
    }
}

/// The numbers after some time in steps of one length, where the swing turns as fast as it should without the body.
template <class S>
typename StiffFollower<S>::Continuous followed(const StiffFollower<S>& system, double drive, double duration, int steps) {
    using System = StiffFollower<S>;
    const typename System::Input turning{S(drive)};
    const Interval<typename System::Input> u{turning, turning, turning};
    integrate::Steps<S, System> kept;
    auto at = system.evaluate(typename System::State{{S(0.5), S(0.4794), S(40.0)}}, turning);
    for (int i = 0; i < steps; ++i) at = system.evaluate(kept(system, at, u, S(duration / steps)), turning);
    return at.state.continuous;
}

int main(int count, char** words) {
    if (count == 1) {
        phi_functions();
        return 0;
    }
    const double kinked = std::atof(words[1]), has_side = std::atof(words[2]), drive = std::atof(words[3]),
                 duration = std::atof(words[4]);
    for (int i = 5; i < count; ++i) {
        const int steps = std::atoi(words[i]);
        const StiffFollower<double> system{.kinked = kinked, .has_side = has_side};
        const auto y = followed(system, drive, duration, steps);
        Dual<1> frequency(2e4);
        frequency.slope[0] = 1.0;
        const StiffFollower<Dual<1>> sloped{.frequency = frequency, .kinked = kinked, .has_side = has_side};
        std::printf("%.17g %.17g %.17g %.17g\n", y.angle, y.place, y.speed,
                    followed(sloped, drive, duration, steps).angle.slope[0]);
    }
}
