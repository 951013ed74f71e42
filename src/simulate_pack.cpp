#include <strainwave/scalar/pack.hpp>

#include "describe.hpp"
#include "simulate.hpp"

namespace strainwave::host {

namespace {

constexpr int lanes = 8;
using Lanes = Pack<lanes>;

/// Members `first` and following as one drive; a last pack that is not full repeats its last member.
AnyPositionDrive<Lanes> packed(const std::vector<Drive>& drives, std::size_t first) {
    std::vector<Parts> members;
    for (std::size_t i = first; i < first + lanes; ++i) members.push_back(parts_of(drives[std::min(i, drives.size() - 1)]));
    return assembled<AnyPositionDrive<Lanes>, Lanes>(members[0].shape, [&](int number) {
        Lanes x;
        for (int lane = 0; lane < lanes; ++lane) x.set(lane, members[lane].numbers[number]);
        return x;
    });
}

}  // namespace

void simulate_packed(const std::vector<Drive>& drives, const Course& course, double* out, std::size_t kept, const Pause& pause) {
    for (std::size_t first = 0; first < drives.size(); first += lanes) {
        const auto drive = packed(drives, first);
        std::size_t k = 0;
        const auto record = [&](const Output<Lanes>& output) {
            const auto values = flattened<Lanes>(output);
            for (std::size_t lane = 0; lane < lanes && first + lane < drives.size(); ++lane)
                for (int c = 0; c < channels; ++c) out[((first + lane) * channels + c) * kept + k] = values[c][int(lane)];
            ++k;
        };
        const auto paused = [&](std::size_t i) { pause(first * course.steps + lanes * i); };
        run<Lanes>(drive, drive.rest(), course, record, paused);
    }
}

}  // namespace strainwave::host
