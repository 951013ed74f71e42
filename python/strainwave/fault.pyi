"""Faults of a drive: changes of its numbers, each by its severity."""

from typing import Any


class Facts:
    """
    Facts of a drive that a fault needs.

    >>> from strainwave.fault import Facts
    >>> Facts(flexspline_teeth=200, circular_spline_teeth=202, ratio=-100.0).fixed
    'circular_spline'

    Parameters
    ----------
    flexspline_teeth: Teeth of the flexspline z_f; 0 if they are not known, in [0, 100000]; default 0
    circular_spline_teeth: Teeth of the circular spline z_c; 0 if they are not known, in [0, 100000]; default 0
    fixed: The member that does not turn; the other spline is the output, one of ('circular_spline', 'flexspline'); default 'circular_spline'
    ratio: Input angle per output angle, signed; default 100.0
    error: Form of the kinematic error: waves, or the geometry of a misalignment, one of ('waves', 'geometry'); default 'waves'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, flexspline_teeth: int = ..., circular_spline_teeth: int = ..., fixed: str = ..., ratio: float = ..., error: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, flexspline_teeth: int = ..., circular_spline_teeth: int = ..., fixed: str = ..., ratio: float = ..., error: str = ...) -> Facts:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def flexspline_teeth(self) -> int:
        """Teeth of the flexspline z_f; 0 if they are not known"""

    @property
    def circular_spline_teeth(self) -> int:
        """Teeth of the circular spline z_c; 0 if they are not known"""

    @property
    def fixed(self) -> str:
        """The member that does not turn; the other spline is the output"""

    @property
    def ratio(self) -> float:
        """Input angle per output angle, signed"""

    @property
    def error(self) -> str:
        """Form of the kinematic error: waves, or the geometry of a misalignment"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'facts'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class Misalignment:
    """
    Input shaft and wave generator that stand off the axis of the circular spline, or lean against it.

    .. math:: e_1 \\leftarrow e_1 + s\\, \\Delta e_1, \\quad \\beta \\leftarrow \\beta + s\\, \\Delta\\beta, \\quad
              e_2 \\leftarrow e_2 + s\\, \\Delta e_2, \\quad \\alpha \\leftarrow \\alpha + s\\, \\Delta\\alpha

    with s = severity, e_1 = housing_eccentricity towards housing_direction, beta = housing_tilt_x, housing_tilt_y, e_2 =
    generator_eccentricity towards generator_direction, alpha = generator_tilt_x, generator_tilt_y. At severity 1 shaft and
    generator are displaced by these numbers from where they are in the healthy drive; eccentricities add as vectors.

    A drive whose kinematic error is a ``kinematic_error.Misalignment`` keeps the geometry of that law: its radii, pressure
    angle, h = offset and ``combine``; those given here are not used. For a drive whose error is a sum of waves, the
    harmonics of this misalignment are added: ``kinematic_error.Misalignment(...).leading()``, to leading order. Without
    offset, tilts have no effect of first order. e_2 and alpha alone give constants, which no harmonic shows.

    >>> from strainwave.fault import Facts, Misalignment
    >>> law = Misalignment(housing_eccentricity=1e-5, combine="single")
    >>> [(place, order, round(1e6 * value, 4)) for place, _, _, value, _, _, _, order in law.changes(Facts())]
    [('gear.kinematic_error', 1.0, 145.5881)]

    Parameters
    ----------
    severity: Share s of the displacements below, in [0, 1]; default 1.0
    housing_eccentricity: Distance e_1 of the input shaft from the axis of the circular spline [m], in [0, inf); default 3e-05
    housing_direction: Direction beta_1 of that distance [rad]; default 0.0
    housing_tilt_x: Lean beta_2 of the input shaft towards x [rad], in [-0.5, 0.5]; default 0.0
    housing_tilt_y: Lean beta_3 of the input shaft towards y [rad], in [-0.5, 0.5]; default 0.0
    generator_eccentricity: Distance e_2 of the wave generator from the input shaft [m], in [0, inf); default 0.0
    generator_direction: Direction alpha_1 of that distance, turning with the shaft [rad]; default 0.0
    generator_tilt_x: Lean alpha_2 of the wave generator on the shaft [rad], in [-0.5, 0.5]; default 0.0
    generator_tilt_y: Lean alpha_3 of the wave generator on the shaft [rad], in [-0.5, 0.5]; default 0.0
    offset: Distance h of the teeth from the point about which things tilt [m]; default 0.004
    major_radius: Half axis a of the wave generator [m], in (0, inf); default 0.02525
    minor_radius: Half axis b of the wave generator [m], in (0, inf); default 0.02475
    pitch_radius: Pitch radius r_g of the circular spline [m], in (0, inf); default 0.025
    pressure_angle: Pressure angle alpha_t of the teeth [rad], in [0, 1.5]; default 0.3490658503988659
    combine: How the two lobes decide on the output, one of ('single', 'mean', 'max'); default 'max'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document A, section Kinematic error, worked out (erratum E-A4); the numbers at severity 1, and `combine`, are assumed
    """

    def __init__(self, *, severity: float = ..., housing_eccentricity: float = ..., housing_direction: float = ..., housing_tilt_x: float = ..., housing_tilt_y: float = ..., generator_eccentricity: float = ..., generator_direction: float = ..., generator_tilt_x: float = ..., generator_tilt_y: float = ..., offset: float = ..., major_radius: float = ..., minor_radius: float = ..., pitch_radius: float = ..., pressure_angle: float = ..., combine: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., housing_eccentricity: float = ..., housing_direction: float = ..., housing_tilt_x: float = ..., housing_tilt_y: float = ..., generator_eccentricity: float = ..., generator_direction: float = ..., generator_tilt_x: float = ..., generator_tilt_y: float = ..., offset: float = ..., major_radius: float = ..., minor_radius: float = ..., pitch_radius: float = ..., pressure_angle: float = ..., combine: str = ...) -> Misalignment:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of the displacements below"""

    @property
    def housing_eccentricity(self) -> float:
        """
        Distance e_1 of the input shaft from the axis of the circular spline [m]
        """

    @property
    def housing_direction(self) -> float:
        """Direction beta_1 of that distance [rad]"""

    @property
    def housing_tilt_x(self) -> float:
        """Lean beta_2 of the input shaft towards x [rad]"""

    @property
    def housing_tilt_y(self) -> float:
        """Lean beta_3 of the input shaft towards y [rad]"""

    @property
    def generator_eccentricity(self) -> float:
        """Distance e_2 of the wave generator from the input shaft [m]"""

    @property
    def generator_direction(self) -> float:
        """Direction alpha_1 of that distance, turning with the shaft [rad]"""

    @property
    def generator_tilt_x(self) -> float:
        """Lean alpha_2 of the wave generator on the shaft [rad]"""

    @property
    def generator_tilt_y(self) -> float:
        """Lean alpha_3 of the wave generator on the shaft [rad]"""

    @property
    def offset(self) -> float:
        """Distance h of the teeth from the point about which things tilt [m]"""

    @property
    def major_radius(self) -> float:
        """Half axis a of the wave generator [m]"""

    @property
    def minor_radius(self) -> float:
        """Half axis b of the wave generator [m]"""

    @property
    def pitch_radius(self) -> float:
        """Pitch radius r_g of the circular spline [m]"""

    @property
    def pressure_angle(self) -> float:
        """Pressure angle alpha_t of the teeth [rad]"""

    @property
    def combine(self) -> str:
        """How the two lobes decide on the output"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'misalignment'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    mode: str = ...

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class ToothWear:
    """
    Teeth of one spline that wear, unevenly around it.

    .. math:: c \\leftarrow c + s\\, \\Delta c, \\qquad e(\\theta) \\leftarrow e(\\theta) + s A \\sin(2 \\rho \\theta + \\varphi)

    with s = severity, Delta c = play, A = amplitude, phi = phase, theta the input angle, rho revolutions of the wave generator
    against the worn spline per revolution of the input. With the circular spline fixed rho is 1 for teeth of the circular
    spline and z_c / z_f for those of the flexspline; with the flexspline fixed it is z_f / z_c and 1. Two lobes pass the worn
    teeth per such revolution. At severity 1 the play at the output has grown by ``play``, and the wave has its amplitude.
    The order of a spline that turns differs from 2 by some 1 %: a record that separates them spans half a revolution of the
    output. Leaves out the particles in the lubricant, and the friction of rough flanks: see LubricationLoss.

    >>> from strainwave.fault import Facts, ToothWear
    >>> facts = Facts(flexspline_teeth=200, circular_spline_teeth=202, ratio=-100.0)
    >>> [(place, order) for place, *_, order in ToothWear().changes(facts)]
    [('gear.stiffness', 0.0), ('gear.kinematic_error', 2.02)]

    Parameters
    ----------
    severity: Share s of play and amplitude, in [0, 1]; default 1.0
    play: Play Delta c at the output, from flank to flank, at severity 1 [rad], in [0, inf); default 0.0003
    amplitude: Amplitude A of the wave of kinematic error at the output, at severity 1 [rad], in [0, inf); default 0.00015
    phase: Phase phi of that wave [rad]; default 0.0
    spline: The spline whose teeth are worn, one of ('flexspline', 'circular_spline'); default 'flexspline'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    order: kinematics of the three members; play and amplitude are assumed (1 and 0.5 arc minutes)
    """

    def __init__(self, *, severity: float = ..., play: float = ..., amplitude: float = ..., phase: float = ..., spline: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., play: float = ..., amplitude: float = ..., phase: float = ..., spline: str = ...) -> ToothWear:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of play and amplitude"""

    @property
    def play(self) -> float:
        """Play Delta c at the output, from flank to flank, at severity 1 [rad]"""

    @property
    def amplitude(self) -> float:
        """
        Amplitude A of the wave of kinematic error at the output, at severity 1 [rad]
        """

    @property
    def phase(self) -> float:
        """Phase phi of that wave [rad]"""

    @property
    def spline(self) -> str:
        """The spline whose teeth are worn"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'tooth_wear'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    mode: str = 'Wear of the teeth of a spline'

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class FlexsplineCrack:
    """
    A crack at one place of the flexspline: the gear is softer while one of the two lobes passes it.

    .. math:: k \\leftarrow k \\left(1 - s\\, d\\, p(\\psi)\\right), \\qquad
              p(\\psi) = \\tfrac{1}{2} \\left(1 + \\cos\\frac{2 \\pi \\psi}{w}\\right) \\text{ for } |\\psi| < \\tfrac{w}{2}, \\qquad
              \\psi = \\rho \\theta - \\psi_0

    with s = severity, d = depth, w = width, psi_0 = angle, theta the input angle, rho revolutions of the wave generator
    against the flexspline per revolution of the input: z_c / z_f if the circular spline is fixed, 1 if the flexspline is.
    There are two lobes, so that p repeats after pi. At severity 1 the stiffness falls by the share d at the middle of the
    pulse. The pulse is held as its mean and ``waves`` harmonics,

    .. math:: p = \\frac{w}{2 \\pi} + \\sum_k a_k \\cos(2 k \\psi), \\qquad
              a_k = \\frac{w}{\\pi} \\frac{\\operatorname{sinc} x}{1 - x^2}, \\qquad x = \\frac{k w}{\\pi}

    with sinc x = sin(pi x) / (pi x). A narrow pulse needs more harmonics; a gear holds 8 waves in all, the mean is one of
    them. Leaves out the error that the crack makes without load, and what opens or closes it.

    >>> from strainwave.fault import Facts, FlexsplineCrack
    >>> facts = Facts(flexspline_teeth=200, circular_spline_teeth=202, ratio=-100.0)
    >>> [round(order, 9) for *_, order in FlexsplineCrack().changes(facts)]
    [0.0, 2.02, 4.04, 6.06, 8.08]

    Parameters
    ----------
    severity: Share s of the depth, in [0, 1]; default 1.0
    depth: Share d of the stiffness that is lost at the middle of the pulse at severity 1, in [0, 0.9]; default 0.3
    width: Width w of the pulse, as an angle of the wave generator against the flexspline [rad], in [0.001, 3.141592653589793]; default 0.6
    angle: Place psi_0 of the crack: that angle at the middle of the pulse [rad]; default 0.0
    waves: Harmonics that the pulse is held by, in [1, 7]; default 4

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    order: kinematics of the three members; the pulse is a raised cosine, and its Fourier series follows from its definition; depth and width are assumed
    """

    def __init__(self, *, severity: float = ..., depth: float = ..., width: float = ..., angle: float = ..., waves: int = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., depth: float = ..., width: float = ..., angle: float = ..., waves: int = ...) -> FlexsplineCrack:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of the depth"""

    @property
    def depth(self) -> float:
        """
        Share d of the stiffness that is lost at the middle of the pulse at severity 1
        """

    @property
    def width(self) -> float:
        """
        Width w of the pulse, as an angle of the wave generator against the flexspline [rad]
        """

    @property
    def angle(self) -> float:
        """Place psi_0 of the crack: that angle at the middle of the pulse [rad]"""

    @property
    def waves(self) -> int:
        """Harmonics that the pulse is held by"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'flexspline_crack'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    mode: str = 'Crack in the flexspline'

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class WaveGeneratorBearing:
    """
    A damaged ring, ball or cage of the thin ball bearing that carries the flexspline on the wave generator.

    .. math:: f \\leftarrow f + s\\, d \\sum_{h=1}^{n} \\tfrac{1}{h} \\sin(h B \\theta + h \\varphi)

    .. math:: B_{outer} = \\tfrac{z}{2} (1 - \\gamma) |1 - r|, \\quad B_{inner} = \\tfrac{z}{2} (1 + \\gamma) |1 - r|, \\quad
              B_{ball} = \\frac{D (1 - \\gamma^2)}{2 d_b} |1 - r|, \\quad
              B_{cage} = \\tfrac{1}{2} [1 - \\gamma + r (1 + \\gamma)]

    with s = severity, f the factor of the friction at the input, and of the stiffness, d = friction_depth and
    stiffness_depth, n = waves, phi = phase, z = balls, d_b = ball_diameter, D = pitch_diameter, gamma = d_b cos(alpha) / D,
    alpha = contact_angle, r = speed of the outer ring over that of the input: it turns with the flexspline, so r = 1 / i if
    the circular spline is fixed, else 0. These are the orders of ``sw.bearing_orders``. At severity 1 the first wave has the
    depth d, relative to the healthy friction or stiffness.

    Leaves out that the inner ring is elliptic: it loads each ball twice a turn, so that lines 2 orders away come as well. A
    damaged ball meets both rings: twice its order is then the stronger.

    >>> from strainwave.fault import Facts, WaveGeneratorBearing
    >>> facts = Facts(flexspline_teeth=200, circular_spline_teeth=202, fixed="flexspline", ratio=101.0)
    >>> bearing = WaveGeneratorBearing(balls=9, ball_diameter=7.94e-3, pitch_diameter=39.04e-3, waves=1)
    >>> [(place, round(order, 4)) for place, *_, order in bearing.changes(facts)]
    [('gear.friction_input', 3.5848)]

    Parameters
    ----------
    severity: Share s of the depths, in [0, 1]; default 1.0
    element: The damaged element, one of ('outer_ring', 'inner_ring', 'ball', 'cage'); default 'outer_ring'
    friction_depth: Depth of the first wave of friction at the input at severity 1, relative, in [0, 1]; default 0.2
    stiffness_depth: Depth of the first wave of stiffness at severity 1, relative, in [0, 0.5]; default 0.0
    balls: Balls z, in [3, 1000]; default 23
    ball_diameter: Diameter d_b of a ball [m], in (0, inf); default 0.004763
    pitch_diameter: Diameter D of the circle of the centres of the balls [m], in (0, inf); default 0.046
    contact_angle: Contact angle alpha, 0 of a deep groove bearing [rad], in [0, 1.5]; default 0.0
    phase: Phase phi of the first wave [rad]; default 0.0
    waves: Waves n: the order and its multiples, in [1, 8]; default 2

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    RandallAntoni2011, eqs. (1) to (4), for the orders; the depths, and waves that fall with their number, are assumed; so are the default balls, no data sheet states them
    """

    def __init__(self, *, severity: float = ..., element: str = ..., friction_depth: float = ..., stiffness_depth: float = ..., balls: int = ..., ball_diameter: float = ..., pitch_diameter: float = ..., contact_angle: float = ..., phase: float = ..., waves: int = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., element: str = ..., friction_depth: float = ..., stiffness_depth: float = ..., balls: int = ..., ball_diameter: float = ..., pitch_diameter: float = ..., contact_angle: float = ..., phase: float = ..., waves: int = ...) -> WaveGeneratorBearing:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of the depths"""

    @property
    def element(self) -> str:
        """The damaged element"""

    @property
    def friction_depth(self) -> float:
        """
        Depth of the first wave of friction at the input at severity 1, relative
        """

    @property
    def stiffness_depth(self) -> float:
        """Depth of the first wave of stiffness at severity 1, relative"""

    @property
    def balls(self) -> int:
        """Balls z"""

    @property
    def ball_diameter(self) -> float:
        """Diameter d_b of a ball [m]"""

    @property
    def pitch_diameter(self) -> float:
        """Diameter D of the circle of the centres of the balls [m]"""

    @property
    def contact_angle(self) -> float:
        """Contact angle alpha, 0 of a deep groove bearing [rad]"""

    @property
    def phase(self) -> float:
        """Phase phi of the first wave [rad]"""

    @property
    def waves(self) -> int:
        """Waves n: the order and its multiples"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'wave_generator_bearing'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    mode: str = ...

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class LubricationLoss:
    """
    A gear that runs short of lubricant: its surfaces touch at higher speeds, and less oil is sheared.

    .. math:: F_{dry} \\leftarrow (1 + s\\, r_d)\\, F_{dry}, \\qquad v_s \\leftarrow (1 + s\\, r_s)\\, v_s, \\qquad
              b \\leftarrow (1 - s\\, f_v)\\, b

    with s = severity, r_d = dry_rise, r_s = stribeck_rise, f_v = viscous_fall; F_dry every dry level of the friction at
    input, mesh and output, losses per load included, v_s the Stribeck speed, b viscous friction. At severity 1 dry friction
    is 1 + r_d times that of the healthy drive. Leaves out the rise of wear and temperature that follows.

    >>> from strainwave.fault import Facts, LubricationLoss
    >>> LubricationLoss(severity=0.5).changes(Facts())[0][:4]
    ('gear.friction_input', 'coulomb', 'scale', 1.5)

    Parameters
    ----------
    severity: Share s of the changes below, in [0, 1]; default 1.0
    dry_rise: Rise r_d of dry friction at severity 1, relative to the healthy drive, in [0, inf); default 1.0
    stribeck_rise: Rise r_s of the Stribeck speed at severity 1, relative to the healthy drive, in [0, inf); default 1.0
    viscous_fall: Fall f_v of viscous friction at severity 1, relative to the healthy drive, in [0, 1]; default 0.5

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Stribeck1902 for the sense: a thinner film carries later, so the Stribeck speed rises; the amounts are assumed
    """

    def __init__(self, *, severity: float = ..., dry_rise: float = ..., stribeck_rise: float = ..., viscous_fall: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., dry_rise: float = ..., stribeck_rise: float = ..., viscous_fall: float = ...) -> LubricationLoss:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of the changes below"""

    @property
    def dry_rise(self) -> float:
        """Rise r_d of dry friction at severity 1, relative to the healthy drive"""

    @property
    def stribeck_rise(self) -> float:
        """
        Rise r_s of the Stribeck speed at severity 1, relative to the healthy drive
        """

    @property
    def viscous_fall(self) -> float:
        """
        Fall f_v of viscous friction at severity 1, relative to the healthy drive
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'lubrication_loss'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    mode: str = 'Loss of lubricant'

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class PreloadLoss:
    """
    Splines that no longer press on each other: the gear is soft, then free, around zero torque.

    .. math:: k_1 \\leftarrow (1 - s\\, f)\\, k_1, \\qquad c \\leftarrow c + s\\, \\Delta c

    with s = severity, f = softening, Delta c = play, k_1 the stiffness of the first segment of a spring: k1 of ThreeSegment
    and Piecewise, a1 of Cubic, flexspline_stiffness of MultiCompliance. A Linear spring has no such segment and gets the
    play alone. At severity 1 the first segment has lost the share f of its stiffness, and the play at the output has grown
    by Delta c. k2 of Piecewise is an increment, so the stiffness above its knee falls by as much as k1. Leaves out that
    friction falls with the preload.

    >>> from strainwave.fault import Facts, PreloadLoss
    >>> PreloadLoss(severity=0.5).changes(Facts())[0][:4]
    ('gear.stiffness', 'k1', 'scale', 0.8)

    Parameters
    ----------
    severity: Share s of softening and play, in [0, 1]; default 1.0
    softening: Share f of the stiffness at low torque that is lost at severity 1, in [0, 0.95]; default 0.4
    play: Play Delta c at the output, from flank to flank, at severity 1 [rad], in [0, inf); default 0.00015

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    the form, a soft and free centre, is assumed; so are softening and play
    """

    def __init__(self, *, severity: float = ..., softening: float = ..., play: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., softening: float = ..., play: float = ...) -> PreloadLoss:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of softening and play"""

    @property
    def softening(self) -> float:
        """Share f of the stiffness at low torque that is lost at severity 1"""

    @property
    def play(self) -> float:
        """Play Delta c at the output, from flank to flank, at severity 1 [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'preload_loss'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    mode: str = 'Loss of preload between the splines'

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class LinkagePlay:
    """
    A worn joint, key or coupling between the gear and its load.

    .. math:: c \\leftarrow c + s\\, \\Delta c

    with s = severity, Delta c = play, c the clearance in series with the spring of the gear. At severity 1 the play at the
    output has grown by Delta c. The inertia between gear and linkage is left out: play of the linkage and play of the teeth
    then are one number, and no measurement at input and load separates them. An encoder on the output shaft of the gear,
    before the linkage, would: the model has its output encoder at the load. Hysteresis and damping of the gear also act
    within the play.

    >>> from strainwave.fault import Facts, LinkagePlay
    >>> LinkagePlay(severity=0.5).changes(Facts())[0][:4]
    ('gear.stiffness', 'clearance', 'add', 0.00025)

    Parameters
    ----------
    severity: Share s of the play, in [0, 1]; default 1.0
    play: Play Delta c at the output, from flank to flank, at severity 1 [rad], in [0, inf); default 0.0005

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition: play in series with a spring; its amount is assumed
    """

    def __init__(self, *, severity: float = ..., play: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., play: float = ...) -> LinkagePlay:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of the play"""

    @property
    def play(self) -> float:
        """Play Delta c at the output, from flank to flank, at severity 1 [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'linkage_play'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    mode: str = 'Play in the linkage between gear and load'

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class EncoderOffset:
    """
    An encoder that slipped on its shaft, or lost counts.

    .. math:: y \\leftarrow y + s\\, x_0

    with s = severity, x_0 = offset, y the angle that the controller sees of ``shaft``. At severity 1 the angle is wrong by
    x_0. A sensor without an offset of its own becomes a ``sensor.Gain`` if it is ideal. Counts lost one after the other are
    an onset: the offset grows with the revolutions.

    >>> from strainwave.fault import EncoderOffset, Facts
    >>> EncoderOffset(shaft="input", severity=0.5).changes(Facts())[0][:4]
    ('sensors.input_angle', 'offset', 'add', 0.0005)

    Parameters
    ----------
    severity: Share s of the offset, in [0, 1]; default 1.0
    shaft: The shaft whose encoder it is, one of ('input', 'output'); default 'output'
    offset: Offset x_0 at severity 1 [rad]; default 0.001

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; the amount is assumed
    """

    def __init__(self, *, severity: float = ..., shaft: str = ..., offset: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., shaft: str = ..., offset: float = ...) -> EncoderOffset:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of the offset"""

    @property
    def shaft(self) -> str:
        """The shaft whose encoder it is"""

    @property
    def offset(self) -> float:
        """Offset x_0 at severity 1 [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'encoder_offset'

    source: str = 'definition; the amount is assumed'

    fields: tuple[dict[str, Any], ...]

    mode: str = 'Offset of an encoder'

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class EncoderEccentricity:
    """
    An encoder whose disc moved off the centre of its shaft.

    .. math:: y \\leftarrow y + s\\, a \\sin(x + \\varphi)

    with s = severity, a = eccentricity, phi = phase, x the angle of ``shaft``. It adds as a vector to the eccentricity that
    the encoder has. At severity 1 the error has the amplitude a. The sensor must be a ``sensor.Encoder``; no other sensor
    depends on where the shaft is.

    >>> from strainwave.fault import EncoderEccentricity, Facts
    >>> EncoderEccentricity(severity=0.5).changes(Facts())[0][:4]
    ('sensors.output_angle', 'eccentricity', 'vector', 5e-05)

    Parameters
    ----------
    severity: Share s of the eccentricity, in [0, 1]; default 1.0
    shaft: The shaft whose encoder it is, one of ('input', 'output'); default 'output'
    eccentricity: Amplitude a of the error at severity 1 [rad], in [0, inf); default 0.0001
    phase: Phase phi of the error [rad]; default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; the amount is assumed
    """

    def __init__(self, *, severity: float = ..., shaft: str = ..., eccentricity: float = ..., phase: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., shaft: str = ..., eccentricity: float = ..., phase: float = ...) -> EncoderEccentricity:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of the eccentricity"""

    @property
    def shaft(self) -> str:
        """The shaft whose encoder it is"""

    @property
    def eccentricity(self) -> float:
        """Amplitude a of the error at severity 1 [rad]"""

    @property
    def phase(self) -> float:
        """Phase phi of the error [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'encoder_eccentricity'

    source: str = 'definition; the amount is assumed'

    fields: tuple[dict[str, Any], ...]

    mode: str = 'Eccentric disc of an encoder'

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """

class SensorBias:
    """
    A sensor that shows too much by a constant. A drift is a bias with an onset that grows.

    .. math:: y \\leftarrow y + s\\, y_0

    with s = severity, y_0 = offset in the unit of ``quantity``: A, N.m or rad/s. At severity 1 the reading is wrong by y_0.
    An ideal sensor becomes a ``sensor.Gain``. Only controllers see sensors: a recording shows the quantities themselves, and
    the bias shows in it as far as the controller reacts. Within one run it is constant.

    >>> from strainwave.fault import Facts, SensorBias
    >>> SensorBias(quantity="current", offset=0.2, severity=0.5).changes(Facts())[0][:4]
    ('sensors.current', 'offset', 'add', 0.1)

    Parameters
    ----------
    severity: Share s of the offset, in [0, 1]; default 1.0
    quantity: What the sensor measures, one of ('current', 'torque', 'input_speed', 'output_speed'); default 'current'
    offset: Offset y_0 at severity 1, in the unit of what the sensor measures; default 0.1

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; the amount is assumed
    """

    def __init__(self, *, severity: float = ..., quantity: str = ..., offset: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, severity: float = ..., quantity: str = ..., offset: float = ...) -> SensorBias:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def severity(self) -> float:
        """Share s of the offset"""

    @property
    def quantity(self) -> str:
        """What the sensor measures"""

    @property
    def offset(self) -> float:
        """Offset y_0 at severity 1, in the unit of what the sensor measures"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'sensor_bias'

    source: str = 'definition; the amount is assumed'

    fields: tuple[dict[str, Any], ...]

    mode: str = ...

    effect: str = ...

    signal: str = ...

    def changes(self, facts: Facts) -> tuple[tuple[str, str, str, float, str, str, float, float], ...]:
        """
        Return the changes that it makes to a drive of these `facts`, the same ones in the same order at every severity: place, quantity, kind, value, law, direction, phase [rad] and order of each. `ValueError` if the drive lacks what the fault needs.
        """
