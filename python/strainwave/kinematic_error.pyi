"""Pure kinematic error at the output, over the input angle."""

from collections.abc import Sequence
from typing import Any, overload

import numpy
import numpy.typing


class Fourier:
    """
    Kinematic error as a sum of harmonics of the wave generator's rotation.

    .. math:: e(\\theta) = \\sum_h A_h \\sin(B_h \\theta + \\varphi_h)

    with theta the input angle, A_h = amplitude at the output, B_h = order, phi_h = phase; up to 16 harmonics, none at all is
    a perfect gear. Orders need not be whole: 2 z_c / z_f occurs. Independent of load and speed.

    >>> from strainwave.kinematic_error import Fourier
    >>> Fourier(order=[2], amplitude=[3e-4], phase=[0.0]).slope(0.0)
    0.0006

    Parameters
    ----------
    order: Order B_h: periods per input revolution, in [0, inf); default ()
    amplitude: Amplitude A_h at the output [rad], in [0, inf); default ()
    phase: Phase phi_h [rad]; default ()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, eq. (1a); sign convention: theta_error = theta_in / i - theta_out
    """

    def __init__(self, *, order: float | Sequence[float] = ..., amplitude: float | Sequence[float] = ..., phase: float | Sequence[float] = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, order: float | Sequence[float] = ..., amplitude: float | Sequence[float] = ..., phase: float | Sequence[float] = ...) -> Fourier:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def order(self) -> tuple[float, ...]:
        """Order B_h: periods per input revolution"""

    @property
    def amplitude(self) -> tuple[float, ...]:
        """Amplitude A_h at the output [rad]"""

    @property
    def phase(self) -> tuple[float, ...]:
        """Phase phi_h [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'fourier'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def error(self, angle: float) -> float: ...

    @overload
    def error(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Kinematic error [rad] at input `angle` [rad]."""

    @overload
    def slope(self, angle: float) -> float: ...

    @overload
    def slope(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Its derivative [rad/rad] by the input angle."""

    def harmonics(self, highest: int = 8) -> Fourier:
        """
        Its harmonics of order 1 to `highest`, at most 16, over one turn of the input: a Fourier law, without the mean.
        """

class Misalignment:
    """
    Kinematic error of a wave generator that sits eccentric and tilted in the circular spline.

    .. math:: e(\\theta) = -\\frac{\\tan\\alpha_t}{r_g} \\operatorname{combine}(\\delta_A, \\delta_B), \\qquad
              \\delta_A = \\rho(\\theta) - a, \\quad \\delta_B = \\rho(\\theta + \\pi) - a

    .. math:: \\rho(\\psi) = \\frac{u^T Q c + \\sqrt{(u^T Q c)^2 - u^T Q u \\, (c^T Q c - 1)}}{u^T Q u}, \\qquad
              u = (\\cos\\psi, \\sin\\psi)

    with theta the input angle, a = major_radius, b = minor_radius, alpha_t = pressure_angle, r_g = pitch_radius. The wave
    generator is an elliptic cylinder with half axes a, b. The plane normal to the input shaft at h = offset from the point
    about which things tilt cuts it in the ellipse of centre c and matrix Q, both turning with theta; rho is the ellipse's
    polar radius about the axis of the circular spline, delta_A and delta_B are the displacements of the two lobes. The
    input shaft stands off the axis of the circular spline by e_1 = housing_eccentricity towards beta_1 = housing_direction
    and leans towards x and y by beta_2 = housing_tilt_x, beta_3 = housing_tilt_y, all at rest in the housing; the generator
    stands on the shaft with e_2 = generator_eccentricity, alpha_1 = generator_direction, alpha_2 = generator_tilt_x,
    alpha_3 = generator_tilt_y, all turning with it. ``combine`` is ``single`` (delta_A: one tooth pair carries), ``mean``
    (two equally stiff lobes) or ``max`` (the lobe further out carries, and the slope jumps where the lobes change).

    What harmonics can tell: with m = ``eccentricity``, close to (e_1 cos beta_1 + h beta_2, e_1 sin beta_1 + h beta_3), and
    c = (e_2 cos alpha_1 + h alpha_2, e_2 sin alpha_1 + h alpha_3), the displacement that varies is, to the order that
    ``leading`` keeps,

    .. math:: \\text{single: } m \\cdot u(\\theta), \\qquad \\text{max: } |c_x + m \\cdot u(\\theta)|, \\qquad
              \\text{mean: } \\frac{a c_y}{b^2} (m_x \\sin\\theta - m_y \\cos\\theta) + \\frac{a}{4}
              \\operatorname{Re}\\left[\\left(\\frac{m^2}{b^2} - \\beta^2\\right) e^{-2 j \\theta}\\right]

    with m and beta = beta_2 + j beta_3 in the last bracket read as complex numbers. Of a single lobe only the vector m is
    identifiable: e_1 is not told from a tilt times h, and a tilt with h = 0 acts in second order only. The misalignment
    of the generator alone (m = 0, beta = 0) gives a constant and no harmonic at all. Beside that of the housing it acts in
    products with m or beta, of second order by c_y and of third by its tilts; c_x reaches the harmonics in first order by
    ``max`` alone, which compares it with m: odd orders appear, and once c_x outgrows m the lobes change no more and what
    remains is that of ``single``.

    Leaves out clearance, tooth errors and the flexspline's elastic fit to the generator. In eq. (2) document A takes e r_g
    for the radial displacement; but the displacement acts through the flank, with the factor tan(alpha_t) / r_g, and
    against the output (E-A4). It also leaves out h, without which no tilt acts in first order, and how the two lobes share.
    In a gear of stages, pitch radius and pressure angle must be those of its structure.

    >>> from strainwave.kinematic_error import Misalignment
    >>> law = Misalignment(major_radius=25.25e-3, minor_radius=24.75e-3, pitch_radius=25e-3, housing_eccentricity=20e-6,
    ...                    combine="single")
    >>> round(law.error(0.0), 10)
    -0.0002911762

    Parameters
    ----------
    major_radius: Major half axis a of the wave generator [m], in (0, inf); required
    minor_radius: Minor half axis b of the wave generator [m], in (0, inf); required
    pitch_radius: Pitch radius r_g [m], in (0, 1]; required
    pressure_angle: Pressure angle alpha_t of the teeth [rad], in (0, 1.5]; default 0.3490658503988659
    offset: Axial distance h of the section from the centre of tilt [m]; default 0.0
    housing_eccentricity: Distance e_1 of the input shaft from the axis of the circular spline [m], in [0, inf); default 0.0
    housing_direction: Direction beta_1 of e_1 in the circular spline [rad]; default 0.0
    housing_tilt_x: Tilt beta_2 of the input shaft towards x of the circular spline [rad], in [-0.5, 0.5]; default 0.0
    housing_tilt_y: Tilt beta_3 of the input shaft towards y of the circular spline [rad], in [-0.5, 0.5]; default 0.0
    generator_eccentricity: Distance e_2 of the wave generator from the input shaft [m], in [0, inf); default 0.0
    generator_direction: Direction alpha_1 of e_2 from the major axis, turning with the shaft [rad]; default 0.0
    generator_tilt_x: Tilt alpha_2 of the wave generator towards its major axis [rad], in [-0.5, 0.5]; default 0.0
    generator_tilt_y: Tilt alpha_3 of the wave generator towards its minor axis [rad], in [-0.5, 0.5]; default 0.0
    combine: How the two lobes decide on the output, one of ('single', 'mean', 'max'); default 'single'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document A, section Kinematic error, worked out: the document prints no equation; erratum E-A4; `combine` and the default values (teeth of module 0.25 mm, 200 and 202) are assumed
    """

    def __init__(self, *, major_radius: float, minor_radius: float, pitch_radius: float, pressure_angle: float = ..., offset: float = ..., housing_eccentricity: float = ..., housing_direction: float = ..., housing_tilt_x: float = ..., housing_tilt_y: float = ..., generator_eccentricity: float = ..., generator_direction: float = ..., generator_tilt_x: float = ..., generator_tilt_y: float = ..., combine: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, major_radius: float = ..., minor_radius: float = ..., pitch_radius: float = ..., pressure_angle: float = ..., offset: float = ..., housing_eccentricity: float = ..., housing_direction: float = ..., housing_tilt_x: float = ..., housing_tilt_y: float = ..., generator_eccentricity: float = ..., generator_direction: float = ..., generator_tilt_x: float = ..., generator_tilt_y: float = ..., combine: str = ...) -> Misalignment:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def major_radius(self) -> float:
        """Major half axis a of the wave generator [m]"""

    @property
    def minor_radius(self) -> float:
        """Minor half axis b of the wave generator [m]"""

    @property
    def pitch_radius(self) -> float:
        """Pitch radius r_g [m]"""

    @property
    def pressure_angle(self) -> float:
        """Pressure angle alpha_t of the teeth [rad]"""

    @property
    def offset(self) -> float:
        """Axial distance h of the section from the centre of tilt [m]"""

    @property
    def housing_eccentricity(self) -> float:
        """
        Distance e_1 of the input shaft from the axis of the circular spline [m]
        """

    @property
    def housing_direction(self) -> float:
        """Direction beta_1 of e_1 in the circular spline [rad]"""

    @property
    def housing_tilt_x(self) -> float:
        """Tilt beta_2 of the input shaft towards x of the circular spline [rad]"""

    @property
    def housing_tilt_y(self) -> float:
        """Tilt beta_3 of the input shaft towards y of the circular spline [rad]"""

    @property
    def generator_eccentricity(self) -> float:
        """Distance e_2 of the wave generator from the input shaft [m]"""

    @property
    def generator_direction(self) -> float:
        """
        Direction alpha_1 of e_2 from the major axis, turning with the shaft [rad]
        """

    @property
    def generator_tilt_x(self) -> float:
        """Tilt alpha_2 of the wave generator towards its major axis [rad]"""

    @property
    def generator_tilt_y(self) -> float:
        """Tilt alpha_3 of the wave generator towards its minor axis [rad]"""

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

    @overload
    def error(self, angle: float) -> float: ...

    @overload
    def error(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Kinematic error [rad] at input `angle` [rad]."""

    @overload
    def slope(self, angle: float) -> float: ...

    @overload
    def slope(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Its derivative [rad/rad] by the input angle."""

    def harmonics(self, highest: int = 8) -> Fourier:
        """
        Its harmonics of order 1 to `highest`, at most 16, over one turn of the input: a Fourier law, without the mean.
        """

    def lobes(self, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
        """
        Radial displacements delta_A, delta_B [m] of the two lobes at input `angle` [rad], each of the shape of `angle`.
        """

    def leading(self) -> Fourier:
        """The harmonics to leading order, in closed form: a Fourier law."""

    @property
    def eccentricity(self) -> tuple[float, float]:
        """What harmonics can tell: the vector m, x and y [m]."""

class ToothErrors:
    """
    Kinematic error of teeth that do not stand where they should: pitch deviations of both splines.

    .. math:: e(\\theta) = \\frac{\\bar F_{output}(\\lambda_{output}) - \\bar F_{fixed}(\\lambda_{fixed})}{r_g}, \\qquad
              F(\\varphi) = \\sum_{n=1}^{16} A_n \\sin(n \\varphi + \\varphi_n)

    .. math:: \\bar F(\\lambda) = \\sum_n s_n \\, W\\!\\left(\\frac{\\pi n \\, \\eta \\, z_f}{2 z}\\right) A_n \\sin(n \\lambda + \\varphi_n),
              \\qquad W(x) = \\frac{\\sin x}{x \\, (1 - x^2 / \\pi^2)}

    with theta the input angle, r_g = pitch_radius, z_f and z_c the teeth, and z, in W, those of the spline whose mean it
    is. F is the cumulative pitch deviation (index deviation) of a spline: how far the flank of the tooth at the angle phi
    along the pitch circle stands from its nominal place, positive in the positive sense of rotation. It is closed, so its
    orders n are whole. A_n is the n-th number of flexspline_amplitude or circular_spline_amplitude, phi_n of the phases;
    ``[0, 4e-6]`` has order 2 alone. phi counts from the tooth that is under the first lobe at input angle 0.

    In the frame of each spline the first lobe stands at an angle lambda. Both splines pass the lobe tooth by tooth, so that
    z_f lambda_f = z_c lambda_c. In the frame of the ``fixed`` spline lambda is theta. In that of the output it is theta z_c
    / z_f (circular spline fixed) or theta z_f / z_c (flexspline fixed). So the fixed spline gives whole orders, and the
    output gives broken orders close to them, such as the review's 2 z_c / z_f. Order n of both beats n times in a turn of
    the output.

    Without torque the output stands where the forces of all engaged teeth balance. Then e is the mean of their deviations,
    weighted by stiffness. Of the flexspline's teeth the share eta = engaged_share is engaged, half of it under each lobe.
    The stiffness is taken to fall as 1 + cos from the major axis to zero at the ends of a zone; W is what this mean leaves
    of order n. The first lobe has the share p = first_lobe of the stiffness of all engaged teeth: s_n = 1 for even n, 2 p -
    1 for odd n. Where both lobes share equally, odd orders cancel: an eccentric spline (n = 1) gives no error, an oval one
    (n = 2) gives all of its own. Torque winds up all pairs alike and does not change e.

    A Fourier series over the teeth turns a measured chart of index deviations into amplitudes and phases. Where only a
    tolerance class is known, give flexspline_deviation and circular_spline_deviation, the total cumulative pitch deviation
    F_p of a typical part; the class states the largest one allowed. They add a random chart with amplitudes sqrt(2 / pi)
    F_p / (pi n) and phases that ``seed`` draws: the mean spectrum of pitches that are cut independently of each other and
    whose range over the turn is F_p in the mean (Feller1951). The 16 orders kept have nine tenths of that range.

    Assumed are: a linear stiffness of each pair, which teeth are engaged, how their stiffness falls, and one pitch radius
    for both splines. Leaves out single teeth as they come and go (orders near the number of teeth), deviations of flank and
    of thickness, teeth that lose contact, load and speed, the radial part of an eccentricity (see Misalignment), runout of
    the output shaft, and deviations of order above 16, of which the engaged teeth leave little. A gear refuses teeth and a
    fixed member that are not those of its kinematics, and a pitch radius that is not that of its stages.

    >>> from strainwave.kinematic_error import ToothErrors
    >>> gear = dict(flexspline_teeth=200, circular_spline_teeth=202, pitch_radius=25e-3, engaged_share=0.3)
    >>> oval = ToothErrors(**gear, circular_spline_amplitude=[0, 5e-6], circular_spline_phase=[0, 1.5707963267948966])
    >>> round(oval.error(0.0), 9)
    -0.000188876
    >>> eccentric = ToothErrors(**gear, flexspline_amplitude=[5e-6], flexspline_phase=[0])
    >>> eccentric.error(1.0), round(eccentric.replace(first_lobe=1.0).error(1.0), 9)
    (0.0, 0.000166923)
    >>> random = ToothErrors(**gear, flexspline_deviation=15e-6, circular_spline_deviation=15e-6, seed=1)
    >>> random.error(0.3) == random.replace(seed=2).error(0.3)
    False

    Parameters
    ----------
    flexspline_teeth: Teeth of the flexspline z_f, in [2, 100000]; required
    circular_spline_teeth: Teeth of the circular spline z_c, in [3, 100000]; required
    fixed: The member that does not turn; the other spline is the output, one of ('circular_spline', 'flexspline'); default 'circular_spline'
    pitch_radius: Pitch radius r_g [m], in (0, 1]; required
    engaged_share: Share eta of the flexspline's teeth that is engaged, at both lobes together, in [0, 1]; required
    first_lobe: Share p of the first lobe in the stiffness of all engaged teeth, in [0, 1]; default 0.5
    flexspline_amplitude: Amplitudes A_n of the flexspline's deviation, orders 1, 2, ... [m], in [0, 0.001]; default ()
    flexspline_phase: Phases phi_n of the flexspline's deviation [rad]; default ()
    circular_spline_amplitude: Amplitudes A_n of the circular spline's deviation, orders 1, 2, ... [m], in [0, 0.001]; default ()
    circular_spline_phase: Phases phi_n of the circular spline's deviation [rad]; default ()
    flexspline_deviation: Total cumulative pitch deviation F_p of a random flexspline [m], in [0, 0.001]; default 0.0
    circular_spline_deviation: Total cumulative pitch deviation F_p of a random circular spline [m], in [0, 0.001]; default 0.0
    seed: Whole number that says which of all such random gears it is, in [0, 16777215]; default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    the cause is named by document A, section Kinematic error, without an equation, and the order 2 z_c / z_f by document R; derived here from the geometry; terms of ISO2013; random chart: Feller1951, ShinozukaDeodatis1991, WichmannHill1982; which teeth are engaged, and how stiff they are, is assumed
    """

    def __init__(self, *, flexspline_teeth: int, circular_spline_teeth: int, fixed: str = ..., pitch_radius: float, engaged_share: float, first_lobe: float = ..., flexspline_amplitude: float | Sequence[float] = ..., flexspline_phase: float | Sequence[float] = ..., circular_spline_amplitude: float | Sequence[float] = ..., circular_spline_phase: float | Sequence[float] = ..., flexspline_deviation: float = ..., circular_spline_deviation: float = ..., seed: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, flexspline_teeth: int = ..., circular_spline_teeth: int = ..., fixed: str = ..., pitch_radius: float = ..., engaged_share: float = ..., first_lobe: float = ..., flexspline_amplitude: float | Sequence[float] = ..., flexspline_phase: float | Sequence[float] = ..., circular_spline_amplitude: float | Sequence[float] = ..., circular_spline_phase: float | Sequence[float] = ..., flexspline_deviation: float = ..., circular_spline_deviation: float = ..., seed: float = ...) -> ToothErrors:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def flexspline_teeth(self) -> int:
        """Teeth of the flexspline z_f"""

    @property
    def circular_spline_teeth(self) -> int:
        """Teeth of the circular spline z_c"""

    @property
    def fixed(self) -> str:
        """The member that does not turn; the other spline is the output"""

    @property
    def pitch_radius(self) -> float:
        """Pitch radius r_g [m]"""

    @property
    def engaged_share(self) -> float:
        """
        Share eta of the flexspline's teeth that is engaged, at both lobes together
        """

    @property
    def first_lobe(self) -> float:
        """Share p of the first lobe in the stiffness of all engaged teeth"""

    @property
    def flexspline_amplitude(self) -> tuple[float, ...]:
        """Amplitudes A_n of the flexspline's deviation, orders 1, 2, ... [m]"""

    @property
    def flexspline_phase(self) -> tuple[float, ...]:
        """Phases phi_n of the flexspline's deviation [rad]"""

    @property
    def circular_spline_amplitude(self) -> tuple[float, ...]:
        """
        Amplitudes A_n of the circular spline's deviation, orders 1, 2, ... [m]
        """

    @property
    def circular_spline_phase(self) -> tuple[float, ...]:
        """Phases phi_n of the circular spline's deviation [rad]"""

    @property
    def flexspline_deviation(self) -> float:
        """Total cumulative pitch deviation F_p of a random flexspline [m]"""

    @property
    def circular_spline_deviation(self) -> float:
        """Total cumulative pitch deviation F_p of a random circular spline [m]"""

    @property
    def seed(self) -> float:
        """Whole number that says which of all such random gears it is"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'tooth_errors'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def error(self, angle: float) -> float: ...

    @overload
    def error(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Kinematic error [rad] at input `angle` [rad]."""

    @overload
    def slope(self, angle: float) -> float: ...

    @overload
    def slope(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Its derivative [rad/rad] by the input angle."""

    def harmonics(self, highest: int = 8) -> Fourier:
        """
        Its harmonics of order 1 to `highest`, at most 16, over one turn of the input: a Fourier law, without the mean.
        """

class Scaled:
    """
    A kinematic error that is smaller under load, and where the wave generator is inserted deeper.

    .. math:: e(\\theta, T) = e_0(\\theta)\\, \\frac{e^{-\\kappa_d d}}{1 + \\kappa_T |T|}

    with theta the input angle, e_0 the error of ``law``, kappa_T = load_sensitivity, d = insertion_depth, kappa_d =
    depth_sensitivity, and T the torque that the ``stiffness`` of the gear has at the twist delta. The twist solves delta +
    e(theta, T(delta)) = theta_in / i - theta_out. Both shafts feel the torque through how the twist follows their angles,
    so that the change of the error under load neither takes energy nor gives any. No catalogue gives the sensitivities:
    measure them, or assume them. The product of load_sensitivity, error and stiffness must stay below 0.8, so that one
    twist belongs to each pair of angles: a run that exceeds it is refused. ``error`` and ``slope`` are those without load,
    at the insertion depth.

    >>> from strainwave.kinematic_error import Fourier, Scaled
    >>> law = Scaled(law=Fourier(order=[2], amplitude=[3e-4], phase=[0.0]), load_sensitivity=0.01)
    >>> law.slope(0.0), round(law.replace(insertion_depth=5e-4, depth_sensitivity=200.0).slope(0.0), 9)
    (0.0006, 0.000542902)

    Parameters
    ----------
    law: The error without load, at insertion depth 0; default Fourier(order=(), amplitude=(), phase=())
    load_sensitivity: How fast the error falls with the torque transmitted [1/(N.m)], in [0, inf); default 0.0
    insertion_depth: Depth d to which the wave generator is inserted into the flexspline [m], in [0, inf); default 0.0
    depth_sensitivity: How fast the error falls with the insertion depth [1/m], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 1b, which scales its random part so (E-R4): here the deterministic error, with a reaction that keeps the energy
    """

    def __init__(self, *, law: Fourier | Misalignment | ToothErrors = ..., load_sensitivity: float = ..., insertion_depth: float = ..., depth_sensitivity: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: Fourier | Misalignment | ToothErrors = ..., load_sensitivity: float = ..., insertion_depth: float = ..., depth_sensitivity: float = ...) -> Scaled:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> Fourier | Misalignment | ToothErrors:
        """The error without load, at insertion depth 0"""

    @property
    def load_sensitivity(self) -> float:
        """How fast the error falls with the torque transmitted [1/(N.m)]"""

    @property
    def insertion_depth(self) -> float:
        """
        Depth d to which the wave generator is inserted into the flexspline [m]
        """

    @property
    def depth_sensitivity(self) -> float:
        """How fast the error falls with the insertion depth [1/m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'scaled'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def error(self, angle: float) -> float: ...

    @overload
    def error(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Kinematic error [rad] at input `angle` [rad]."""

    @overload
    def slope(self, angle: float) -> float: ...

    @overload
    def slope(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Its derivative [rad/rad] by the input angle."""

    def harmonics(self, highest: int = 8) -> Fourier:
        """
        Its harmonics of order 1 to `highest`, at most 16, over one turn of the input: a Fourier law, without the mean.
        """

class Stochastic:
    """
    Random kinematic error of a given band of orders: smooth, the same for the same seed.

    .. math:: n(\\theta) = a \\sqrt{\\frac{2}{N}} \\sum_{k=1}^{N} \\cos(B_k \\theta + \\varphi_k), \\qquad
              a = A \\, \\frac{1 + s_\\omega |\\omega|}{1 + s_T |T|} \\, e^{-s_d d}

    with theta the input angle, omega the input speed, T the elastic torque at the reference temperature, A = amplitude, s_omega = speed_sensitivity,
    s_T = load_sensitivity, s_d = depth_sensitivity, d = insertion_depth of the wave generator in the flexspline. a is the
    root mean square over many turns. The band from lowest_order to highest_order has N = 32 equal cells; each holds one
    order B_k, its place in the cell and its phase phi_k drawn by ``seed``. A function of the angle and of nothing that
    happened before: reproducible, differentiable, independent of the time step, which must resolve the highest order. If the
    ends of the band are whole numbers, it repeats itself after 16384 input turns at most, 512 in the default band. Every
    scalar type draws the same orders and phases.

    The review says that the stochastic part falls with load, rises with speed and falls with the insertion depth, but not
    how: the forms are assumed, and all three are off by default. What it calls stochastic contains the deterministic
    resonance of the elastic gear too (E-R4), which is not meant here. Its spectrum is flat, its values are close to Gaussian.
    ``slope`` is the derivative by theta at constant a. Over few turns the root mean square is another one: a record has
    to span the inverse of a cell's width, in turns, several times.

    >>> from strainwave.kinematic_error import Stochastic
    >>> noise = Stochastic(amplitude=2e-5, seed=7, load_sensitivity=0.1)
    >>> noise.error(0.3) == 2.0 * noise.error(0.3, torque=-10.0)
    True

    Parameters
    ----------
    amplitude: Root mean square A at the output, without load and at rest; 0 is no noise [rad], in [0, 1]; default 0.0
    lowest_order: Lower end of the band: periods per input revolution, in [0, 10000]; default 8.0
    highest_order: Upper end of the band: periods per input revolution, in (0, 10000]; default 40.0
    seed: Whole number that says which of all such errors it is, in [0, 16777215]; default 0.0
    load_sensitivity: How fast the amplitude falls with the torque transmitted [1/(N.m)], in [0, inf); default 0.0
    speed_sensitivity: How fast the amplitude rises with the input speed [s/rad], in [0, inf); default 0.0
    insertion_depth: Depth d to which the wave generator is inserted into the flexspline [m], in [0, inf); default 0.0
    depth_sensitivity: How fast the amplitude falls with the insertion depth [1/m], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section on the kinematic error, which states directions only: the laws of load, speed and depth and the default band are assumed; spectral representation: ShinozukaDeodatis1991; random numbers: WichmannHill1982
    """

    def __init__(self, *, amplitude: float = ..., lowest_order: float = ..., highest_order: float = ..., seed: float = ..., load_sensitivity: float = ..., speed_sensitivity: float = ..., insertion_depth: float = ..., depth_sensitivity: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, amplitude: float = ..., lowest_order: float = ..., highest_order: float = ..., seed: float = ..., load_sensitivity: float = ..., speed_sensitivity: float = ..., insertion_depth: float = ..., depth_sensitivity: float = ...) -> Stochastic:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def amplitude(self) -> float:
        """
        Root mean square A at the output, without load and at rest; 0 is no noise [rad]
        """

    @property
    def lowest_order(self) -> float:
        """Lower end of the band: periods per input revolution"""

    @property
    def highest_order(self) -> float:
        """Upper end of the band: periods per input revolution"""

    @property
    def seed(self) -> float:
        """Whole number that says which of all such errors it is"""

    @property
    def load_sensitivity(self) -> float:
        """How fast the amplitude falls with the torque transmitted [1/(N.m)]"""

    @property
    def speed_sensitivity(self) -> float:
        """How fast the amplitude rises with the input speed [s/rad]"""

    @property
    def insertion_depth(self) -> float:
        """
        Depth d to which the wave generator is inserted into the flexspline [m]
        """

    @property
    def depth_sensitivity(self) -> float:
        """How fast the amplitude falls with the insertion depth [1/m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'stochastic'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def error(self, angle: float, torque: float = 0.0, speed: float = 0.0) -> float: ...

    @overload
    def error(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64], torque: float = 0.0, speed: float = 0.0) -> numpy.typing.NDArray[numpy.float64]:
        """
        Random kinematic error [rad] at input `angle` [rad], under `torque` [N.m] at `speed` [rad/s] of the input.
        """

    @overload
    def slope(self, angle: float, torque: float = 0.0, speed: float = 0.0) -> float: ...

    @overload
    def slope(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64], torque: float = 0.0, speed: float = 0.0) -> numpy.typing.NDArray[numpy.float64]:
        """Its derivative [rad/rad] by the input angle, at constant amplitude."""

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""
