#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

/// Onsets of faults over the use of a drive. Such a law has
///
///     share(usage)     the share of its severity, in [0, 1], that a fault has reached
namespace strainwave::onset {

/// Unit of usage.
///
/// The transmitted work is the integral of the torque times the angle of the output, both without sign [J]. The wear of teeth is
/// in proportion to it: load times sliding distance (Archard1953).
enum class Unit { output_revolutions, load_cycles, transmitted_work };
constexpr Array<const char*, 3> choices(Unit) { return {{"output_revolutions", "load_cycles", "transmitted_work"}}; }

}  // namespace strainwave::onset
