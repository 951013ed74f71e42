#pragma once

namespace strainwave {

/// Default temperature, K.
inline constexpr double room_temperature = 293.15;

}  // namespace strainwave
