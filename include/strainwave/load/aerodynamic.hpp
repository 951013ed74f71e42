#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::load {

template <class S>
struct Aerodynamic {
    S inertia{0.01};
    S area{0.1};
    S chord{0.2};
    S airspeed{0.0};
    S density{1.225};
    S moment_coefficient{0.0};
    S moment_slope{0.1};
    S neutral_angle{0.0};
    S drag_coefficient{0.0};
    S drag_radius{0.1};

    static constexpr auto name = "aerodynamic";
    static constexpr auto source =
        "definition of the hinge moment coefficient: EtkinReid1996, section 2.5; sin in place of the angle, and the drag of "
        "turning "
        "are ours; density of the standard atmosphere at sea level: ISO1975";
    static constexpr auto doc = R"(
        Body in an air stream: a control surface, a tilting nacelle.

        .. math:: T_{load} = \tfrac{1}{2} \rho V^2 S \bar c\,(C_0 + C_1 \sin(\theta_{out} - \theta_0))
                  + \tfrac{1}{2} \rho S C_d r^3 |\omega_{out}| \omega_{out}

        with V = airspeed, rho = density, S = area, c = chord, C_0 = moment_coefficient, C_1 = moment_slope, theta_0 =
        neutral_angle, C_d = drag_coefficient of the surface as it turns, at the radius r = drag_radius. C_1 > 0 drives back to
        the neutral angle. The sine continues the linear law of small angles to all angles. For measured moments of a
        particular body use TorqueTable. Gusts are the run's input load_torque.

        >>> from strainwave.loads import Aerodynamic
        >>> Aerodynamic(area=0.5, chord=0.3, airspeed=40.0).density
        1.225)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Inertia about the output axis", smallest));
        visit(SW_FIELD(m, area, "m2", "Reference area S", 0));
        visit(SW_FIELD(m, chord, "m", "Reference length c", 0));
        visit(SW_FIELD(m, airspeed, "m/s", "Speed V of the stream", 0));
        visit(SW_FIELD(m, density, "kg/m3", "Density rho of the air", 0));
        visit(SW_FIELD(m, moment_coefficient, "1", "Hinge moment coefficient C_0 at the neutral angle"));
        visit(SW_FIELD(m, moment_slope, "1/rad", "Rise C_1 of that coefficient with the angle"));
        visit(SW_FIELD(m, neutral_angle, "rad", "Angle theta_0"));
        visit(SW_FIELD(m, drag_coefficient, "1", "Drag coefficient C_d of turning", 0));
        visit(SW_FIELD(m, drag_radius, "m", "Radius r at which that drag acts", 0));
    }

    constexpr S torque(const S& angle, const S& speed) const {
        const S pressure = S(0.5) * density * area;
        const S hinge = airspeed * airspeed * chord * (moment_coefficient + moment_slope * sin(angle - neutral_angle));
        const S drag = drag_coefficient * drag_radius * drag_radius * drag_radius * abs(speed) * speed;
        return pressure * (hinge + drag);
    }
    constexpr S steepest() const { return S(0.5) * density * area * airspeed * airspeed * chord * abs(moment_slope); }
};

}  // namespace strainwave::load
