#pragma once

namespace strainwave {

/// What a temperature is where none is given, K.
inline constexpr double room_temperature = 293.15;

}  // namespace strainwave
