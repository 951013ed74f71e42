#pragma once
#include <strainwave/field.hpp>

/// The rigid motion. The signed ratio is input angle over output angle; nothing in the product takes a ratio whose sign or
/// fixed member is unknown.
namespace strainwave::kinematics {

enum class Fixed { circular_spline, flexspline };
constexpr Array<const char*, 2> choices(Fixed) { return {{"circular_spline", "flexspline"}}; }

/// The ratio worked out, with its inverse at hand.
template <class S>
struct Reduction {
    S reduction{1.0};
    S inverse{1.0};

    constexpr S ratio() const { return reduction; }
    constexpr S inverse_ratio() const { return inverse; }
};

template <class S>
struct StrainWave {
    int flexspline_teeth{200};
    int circular_spline_teeth{202};
    Fixed fixed{Fixed::circular_spline};

    static constexpr auto name = "strain_wave";
    static constexpr auto source = "kinematics of the three members: z_c w_c - z_f w_f = (z_c - z_f) w_w";
    static constexpr auto doc = R"(
        Ratio of a strain wave gear from its teeth and its fixed member.

        .. math:: i = \omega_{in} / \omega_{out} = -z_f / (z_c - z_f) \text{ (circular spline fixed)}, \quad
                  i = z_c / (z_c - z_f) \text{ (flexspline fixed)}

        with z_f = flexspline_teeth, z_c = circular_spline_teeth. A fixed circular spline reverses the motion, a fixed
        flexspline does not.

        >>> from strainwave.kinematics import StrainWave
        >>> StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline").ratio
        -100.0
        >>> StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="flexspline").ratio
        101.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, flexspline_teeth, "1", "Teeth of the flexspline z_f", 2, 100000));
        visit(SW_FIELD(m, circular_spline_teeth, "1", "Teeth of the circular spline z_c", 3, 100000));
        visit(SW_FIELD(m, fixed, "1", "The member that does not turn; the other spline is the output"));
    }

    constexpr const char* problem() const {
        return circular_spline_teeth > flexspline_teeth ? nullptr : "circular_spline_teeth must exceed flexspline_teeth";
    }

    /// Input angle per output angle, signed.
    constexpr S ratio() const {
        const int teeth = fixed == Fixed::circular_spline ? -flexspline_teeth : circular_spline_teeth;
        return S(teeth) / S(circular_spline_teeth - flexspline_teeth);
    }
    constexpr S inverse_ratio() const { return S(1.0) / ratio(); }
    constexpr Reduction<S> compile() const { return {ratio(), inverse_ratio()}; }
};

template <class S>
struct PlainRatio {
    S reduction{100.0};

    static constexpr auto name = "plain_ratio";
    static constexpr auto source =
        SW_POSITION_ARTICLE ", eqs. of motion, which leave out the sign of the ratio; with r = 1/100, not 100";
    static constexpr auto doc = R"(
        Reducer of a known reduction, whose output turns with the input.

        .. math:: i = \omega_{in} / \omega_{out} = \text{reduction}

        The degenerate kinematics of texts that ignore the sign; prefer StrainWave.

        >>> from strainwave.kinematics import PlainRatio
        >>> PlainRatio(reduction=100.0).ratio
        100.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, reduction, "1", "Input angle per output angle", smallest));
    }

    /// Input angle per output angle.
    constexpr S ratio() const { return reduction; }
    constexpr S inverse_ratio() const { return S(1.0) / reduction; }
    constexpr Reduction<S> compile() const { return {ratio(), inverse_ratio()}; }
};

}  // namespace strainwave::kinematics
