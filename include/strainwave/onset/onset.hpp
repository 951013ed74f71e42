#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

/// Onsets of faults over the use of a drive. Such a law has
///
///     share(usage)     the share of its severity, in [0, 1], that a fault has reached
namespace strainwave::onset {

/// Unit of usage.
enum class Unit { output_revolutions, load_cycles };
constexpr Array<const char*, 2> choices(Unit) { return {{"output_revolutions", "load_cycles"}}; }

}  // namespace strainwave::onset
