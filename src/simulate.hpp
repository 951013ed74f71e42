#pragma once
#include "run.hpp"

#include <vector>

/// The three ways to run a course. One translation unit each, so that they compile side by side.
namespace strainwave::host {

using Drive = AnyPositionDrive<double>;
using Pause = std::function<void(std::size_t)>;

inline constexpr int channels = [] {
    Output<double> output{};
    detail::Counter<double> counter;
    Output<double>::fields(output, counter);
    return counter.count;
}();

/// One trajectory. Writes channel c of kept sample k to out[c * kept + k].
Drive::State simulate(const Drive& drive, const Drive::State& start, const Course& course, double* out, std::size_t kept,
                      const Pause& pause);

/// Drives of equal shape side by side, from rest, several to a pack. Writes to out[(member * channels + c) * kept + k].
void simulate_packed(const std::vector<Drive>& drives, const Course& course, double* out, std::size_t kept, const Pause& pause);

/// The outputs of a drive in state `x`.
void observe(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out);

/// The outputs of a drive at rest, and their derivatives as `differentiate` gives them, for one sample.
void observe_derivatives(const Drive& drive, const Input<double>& u, const std::vector<int>& parameters, double* out,
                         double* slopes);

/// One trajectory from rest and its derivatives with respect to the numbered parameters of the drive.
/// Writes values to out[c * kept + k], derivatives to slopes[(p * channels + c) * kept + k].
void differentiate(const Drive& drive, const Course& course, const std::vector<int>& parameters, double* out, double* slopes,
                   std::size_t kept, const Pause& pause);

/// Quasi-static torque of a gear, virgin at the first point, along a path of twist; derivatives in slopes[p * n + i].
void differentiate_loop(const AnyGear<double>& gear, const double* twist, std::size_t n, const std::vector<int>& parameters,
                        double* out, double* slopes);

/// Steady friction torque at the input; derivatives in slopes[p * n + i].
void differentiate_steady(const AnyGear<double>& gear, const double* speed, std::size_t n, const std::vector<int>& parameters,
                          double* out, double* slopes);

}  // namespace strainwave::host
