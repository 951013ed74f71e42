#pragma once
#include <strainwave/math.hpp>

namespace strainwave {

/// Geometry of a ball bearing whose inner ring turns with the input: diameters in m, contact angle in rad, speed of the outer ring
/// over that of the input.
template <class S>
struct BallBearingGeometry {
    int balls;
    S ball_diameter, pitch_diameter, contact_angle, outer_speed;

    /// True if the balls have room on their circle.
    constexpr bool fits() const { return all(ball_diameter <= pitch_diameter * sin(S(pi) / S(balls))); }
    static constexpr const char* too_large =
        "the balls must fit on their circle: ball_diameter must not exceed pitch_diameter sin(pi / balls)";

    // Orders over the input, of balls that roll without slip: RandallAntoni2011, eqs. (1) to (4), for the speeds relative to each
    // other.

    /// The cage goes round.
    constexpr S cage() const { return S(0.5) * (S(1.0) - share() + outer_speed * (S(1.0) + share())); }
    /// A ball passes a place of the outer ring.
    constexpr S outer_ring() const { return S(0.5) * S(balls) * (S(1.0) - share()) * passing(); }
    /// A ball passes a place of the inner ring.
    constexpr S inner_ring() const { return S(0.5) * S(balls) * (S(1.0) + share()) * passing(); }
    /// A ball turns about itself.
    constexpr S ball() const { return S(0.5) * pitch_diameter / ball_diameter * (S(1.0) - share() * share()) * passing(); }

private:
    constexpr S share() const { return ball_diameter / pitch_diameter * cos(contact_angle); }
    constexpr S passing() const { return abs(S(1.0) - outer_speed); }
};

}  // namespace strainwave
