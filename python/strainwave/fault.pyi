"""What fails in a drive: changes of its numbers, each by its severity."""

from typing import Any


class Facts:
    """
    What a fault needs of its drive.

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
    >>> [order for *_, order in FlexsplineCrack().changes(facts)]
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
