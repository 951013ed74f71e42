#include <cstdio>
#include <cstdlib>
#include <strainwave/scalar/dual.hpp>
#include <strainwave/scalar/pack.hpp>

#include "stiff_follower.hpp"

using namespace strainwave;

constexpr int size = 6;

/// Reads a matrix from the input, row by row.
bool read(integrate::Square<double, size>& z) {
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
            if (std::scanf("%lf", &z[j][i]) != 1) return false;
    return true;
}
void write(const integrate::Square<double, size>& z) {
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) std::printf("%.17g ", z[j][i]);
    std::printf("\n");
}

/// exp Z, phi_1, phi_2 and phi_3 of each matrix of the input, and whether a pack of several gives the same bits.
void phi_functions() {
    using Phi = integrate::PhiFunctions<double, size>;
    using Lanes = Pack<4>;
    integrate::Square<double, size> z;
    while (read(z)) {
        const Phi phi = Phi::of(z);
        write(phi.exponential);
        write(phi.first);
        write(phi.second);
        write(phi.third);
        integrate::Square<Lanes, size> several;
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i)
                for (int lane = 0; lane < 4; ++lane) several[j][i].set(lane, z[j][i] * (lane == 1 ? 1.0 : 0.01 * lane));
        const auto packed = integrate::PhiFunctions<Lanes, size>::of(several);
        int different = 0;
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i) different += packed.third[j][i][1] != phi.third[j][i];
        std::printf("%d\n", different);
    }
}

/// The numbers after `duration` in steps of one length.
template <class S>
typename StiffFollower<S>::Continuous followed(const StiffFollower<S>& system, double duration, int steps) {
    using System = StiffFollower<S>;
    const Interval<typename System::Input> none{};
    integrate::Steps<S, System> kept;
    auto at = system.evaluate(typename System::State{{S(0.5), S(0.4794), S(0.0)}}, none.start);
    for (int i = 0; i < steps; ++i) at = system.evaluate(kept(system, at, none, S(duration / steps)), none.end);
    return at.state.continuous;
}

int main(int count, char** words) {
    if (count == 1) {
        phi_functions();
        return 0;
    }
    const double kinked = std::atof(words[1]), duration = std::atof(words[2]);
    for (int i = 3; i < count; ++i) {
        const int steps = std::atoi(words[i]);
        const StiffFollower<double> system{.kinked = kinked};
        const auto y = followed(system, duration, steps);
        const StiffFollower<Dual<1>> with_slope{.frequency = [] {
            Dual<1> x(2e4);
            x.slope[0] = 1.0;
            return x;
        }(), .kinked = kinked};
        const auto slope = followed(with_slope, duration, steps);
        std::printf("%.17g %.17g %.17g %.17g %.17g\n", y.angle, y.place, y.speed, slope.place.slope[0], slope.angle.slope[0]);
    }
}
