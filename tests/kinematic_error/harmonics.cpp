/// Sums of harmonics at pairs of angles, alone and together.
#include <strainwave/kinematic_error/fourier.hpp>

#include <cstdio>
#include <cstring>

using strainwave::Angle;
using strainwave::kinematic_error::Fourier;

/// Reads a count of harmonics and order, amplitude and phase of each; then angles and turns in pairs. Writes value and slope of
/// each angle, and 1 where both together have the bits that each has alone.
int main() {
    Fourier<double> law;
    int count;
    if (std::scanf("%d", &count) != 1) return 1;
    law.order.count = law.amplitude.count = law.phase.count = count;
    for (int h = 0; h < count; ++h)
        if (std::scanf("%lf %lf %lf", &law.order[h], &law.amplitude[h], &law.phase[h]) != 3) return 1;
    const auto compiled = law.compile();
    Angle<double> one{}, other{};
    while (std::scanf("%lf %lf %lf %lf", &one.within, &one.turns, &other.within, &other.turns) == 4) {
        const auto together = compiled.at(one, other);
        const strainwave::kinematic_error::Error<double> alone[2]{compiled.at(one), compiled.at(other)};
        std::printf("%.17g %.17g %.17g %.17g %d\n", together[0].value, together[0].slope, together[1].value, together[1].slope,
                    std::memcmp(&together, alone, sizeof alone) == 0);
    }
}
