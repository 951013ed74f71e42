"""The set of a gear that is in no catalogue, from its maker's data sheet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import hypot
from typing import Any

from strainwave import Gear, arguments, friction, hysteresis, kinematic_error, kinematics, stiffness
from strainwave.files import typical_gear as typical
from strainwave.files.entries import Entry, Figure, Quantity, quantity_of
from strainwave.messages import listed, shortened, unquoted

FIGURE_UNITS = {
    "k1": "N.m/rad", "k2": "N.m/rad", "k3": "N.m/rad", "t1": "N.m", "t2": "N.m",
    "hysteresis_loss": "rad", "lost_motion": "rad", "transmission_accuracy": "rad",
    "starting_torque": "N.m", "backdriving_torque": "N.m", "no_load_running_torque": "N.m", "no_load_running_speed": "rad/s",
    "efficiency": "1", "efficiency_torque": "N.m", "efficiency_speed": "rad/s", "wave_generator_inertia": "kg.m2",
    "rated_torque": "N.m", "average_torque": "N.m", "peak_torque": "N.m", "momentary_torque": "N.m",
    "ratcheting_torque": "N.m", "buckling_torque": "N.m", "maximum_input_speed": "rad/s", "average_input_speed": "rad/s",
}  # fmt: skip
RATING_NAMES = (*(name for name in FIGURE_UNITS if name.endswith("_torque") and name.split("_")[0] in
             ("rated", "average", "peak", "momentary", "ratcheting", "buckling")),
           "maximum_input_speed", "average_input_speed", "lost_motion")  # fmt: skip
FIGURE_RANGES = {  # of the figures of a strain wave gear, and far beyond, by their unit
    "N.m/rad": (1e-6, 1e12), "N.m": (1e-9, 1e9), "rad": (1e-12, 1.0), "rad/s": (1e-9, 1e6), "1": (1e-3, 1e3),
    "kg.m2": (1e-15, 1e3),
}  # fmt: skip
SIZE_RANGE = (1.0, 1000.0)  # as in the makers' names
MAX_SPREAD = 10.0  # relative
SHEET_TABLE = "datasheet"


@dataclass(frozen=True)
class DatasheetGear:
    """A gear by the figures of its data sheet, as `GearSet.from_datasheet` takes it.

    Attributes:
        gear: its model
        name, maker, source: of it
        sources: of its numbers, by path; of others `source`
        note: contradictions of the sheet
        ratings: what the maker allows, by name
    """

    gear: Gear
    name: str
    maker: str
    source: str
    sources: Mapping[str, Entry]
    note: str
    ratings: Mapping[str, Quantity]


def from_datasheet(
    ratio: float,
    *,
    fixed: str | None = None,
    size: float | None = None,
    name: str = "",
    maker: str = "",
    source: str = "data sheet",
    spread: float = typical.UNITS_SPREAD,
    **figures: Figure,
) -> DatasheetGear:
    """Return a gear from the figures of its data sheet, by the rules by which the catalogue was made.

    Each figure is a number in SI units, a text as the sheet has it, "1.2 N·m/arcmin", "3.1 × 10^4 N·m/rad", "3.4 cN·m", "0.5
    kgf·m", or a `Quantity` with its own source. What is not given is estimated from the catalogue's gears of the size; the size
    is `size`, else what the stiffness speaks for, else the rated torque, else the inertia, else 25. Its source then begins with
    "assumed", and its spread holds the scatter of the catalogue about the estimate, what is not known of the size, and the
    scatter of individual gears.

    Args:
        ratio: of the sheet, that with the circular spline held; negative, the signed one; positive, it needs `fixed`
        fixed: the spline that is held, "circular_spline" or "flexspline"; then the gear turns ratio or ratio + 1 times slower
        size: as in the makers' names, 25 in HFUC-25-100: about the pitch diameter in tenths of an inch
        name, maker: of the gear; "gear of ratio 100" if not given
        source: of the figures, one line of text, as "data sheet of 2024-03"
        spread: scatter of individual gears about the stiffness and the torque limits of the sheet, relative; ±30 % (Harmonic
            Drive)
        k1, k2, k3: secant up to T1, slopes to T2 and beyond, of the whole gear at its output [N.m/rad]
        t1, t2: the torques between them [N.m]
        hysteresis_loss: bound on the width of the torsion loop at zero torque [rad]; 3 or 1 arcmin if not given, or the lost
            motion
        lost_motion: bound on the turn between ± 4 % of the rated torque [rad]
        transmission_accuracy: bound on the kinematic error, peak to peak [rad]
        starting_torque: that starts the unloaded gear, at its input [N.m]
        backdriving_torque: the same at its output [N.m]; taken where there is no starting torque
        no_load_running_torque, no_load_running_speed: of the input, without load [N.m], [rad/s]; both or none
        efficiency, efficiency_torque, efficiency_speed: at which torque of the output (the rated one if not given) and speed of
            the input; what is lost beyond the friction without load grows with the load
        wave_generator_inertia: at the input [kg.m2]
        rated_torque, average_torque, peak_torque, momentary_torque, ratcheting_torque, buckling_torque, maximum_input_speed,
            average_input_speed: what the maker allows, the ratings of the set

    Returns:
        The gear, with source and spread of each number, of which `GearSet.from_datasheet` makes a set

    Raises:
        TypeError: a figure is no number, text or quantity; an unknown figure
        ValueError: a figure has the wrong unit, lies outside of `FIGURE_RANGES`, or contradicts another so that no gear can
            have both

    >>> found = from_datasheet(-100, size=25, k1="31e3 N.m/rad", t1="14 N·m", hysteresis_loss="1 arcmin")
    >>> round(found.gear.stiffness.k1, 1), found.gear.kinematics.ratio
    (26700.5, -100.0)
    >>> found.sources["gear.stiffness.k2"].assumed, round(found.gear.stiffness.k2, -2)
    (True, 48200.0)
    """
    unknown = [each for each in figures if each not in FIGURE_UNITS]
    if unknown:
        raise TypeError(f"{unquoted(unknown[0])} is no figure of a data sheet; there are {', '.join(FIGURE_UNITS)}")
    quantities = {
        each: quantity_of(each, figure, FIGURE_UNITS[each], source) for each, figure in figures.items() if figure is not None
    }
    for each, quantity in quantities.items():
        arguments.number(
            each, quantity.to(FIGURE_UNITS[each]).value, FIGURE_UNITS[each], "[]", *FIGURE_RANGES[FIGURE_UNITS[each]]
        )
    sheet = _Sheet.of(
        _kinematics(ratio, fixed),
        abs(float(ratio)),
        quantities,
        size,
        arguments.number("spread", spread, brackets="[]", low=0.0, high=MAX_SPREAD),
        source,
    )
    gear, sources, notes = sheet.gear()
    called = name or f"gear of ratio {abs(float(ratio)):g}"
    ratings = {each: quantities[each] for each in RATING_NAMES if each in quantities}
    return DatasheetGear(gear, called, maker, source, sources, " ".join(notes), ratings)


def read(content: Mapping[str, Any]) -> DatasheetGear:
    """Return the gear of a file whose table [datasheet] contains the figures, as `from_datasheet` takes them."""
    texts = {key: value for key, value in content.items() if key != SHEET_TABLE}
    for key, value in texts.items():
        if key not in ("name", "maker", "source"):
            raise ValueError(
                f"{unquoted(key)}: only name, maker and source may stand outside [{SHEET_TABLE}]; to add, save the set "
                "to a gear file"
            )
        arguments.text(key, value)
    sheet = content[SHEET_TABLE]
    if not isinstance(sheet, dict):
        raise ValueError(f'{SHEET_TABLE} must be a table: [{SHEET_TABLE}], below it ratio = -100, k1 = "31e3 N.m/rad"')
    if "ratio" not in sheet:
        raise ValueError(f"[{SHEET_TABLE}] ratio is missing; write ratio = -100")
    keys = {"ratio", "fixed", "size", "spread", *FIGURE_UNITS}
    if wrong := [key for key in sheet if key not in keys]:
        raise ValueError(
            f"[{SHEET_TABLE}] {unquoted(wrong[0])}: not a figure of a data sheet; it has {', '.join(sorted(keys))}"
        )
    for key in FIGURE_UNITS:
        if key in sheet and not isinstance(sheet[key], str) and FIGURE_UNITS[key] != "1":
            written = shortened(sheet[key])
            raise ValueError(f'[{SHEET_TABLE}] {key} = {written} has no unit; write {key} = "{written} {FIGURE_UNITS[key]}"')
    return from_datasheet(**texts, **sheet)


@dataclass(frozen=True)
class _Sheet:
    """The figures of a sheet, and the size that stands in for those that are not there."""

    kinematics: Any
    nominal: float
    given: Mapping[str, Quantity]
    size: float
    sized: str
    size_spread: float
    spread: float
    source: str

    @classmethod
    def of(
        cls, moves: Any, nominal: float, given: Mapping[str, Quantity], size: float | None, spread: float, source: str
    ) -> _Sheet:
        if size is not None:
            value = arguments.number("size", size, "", "[]", *SIZE_RANGE)
            return cls(moves, nominal, given, value, f"size {value:g}", 0.0, spread, source)
        for names in typical.SIZED_BY:
            figures = {name: given[name].to(FIGURE_UNITS[name]).value for name in names if name in given}
            if figures:
                value = typical.mean_size(figures, nominal)
                laws = [typical.law(name, nominal) for name in figures]
                off = max(law.scatter / law.exponent for law in laws)
                return cls(moves, nominal, given, value, f"size {value:.3g} by its {listed(figures)}", off, spread, source)
        value = typical.ANY_SIZE
        return cls(
            moves, nominal, given, value, f"size {value:g}, as no figure determines it", typical.ANY_SIZE_SPREAD, spread, source
        )

    def value(self, name: str) -> float | None:
        return self.given[name].to(FIGURE_UNITS[name]).value if name in self.given else None

    def entry(self, name: str, detail: str, spread: float | None = None) -> Entry:
        """Return the entry of a number that a figure of the sheet determines."""
        figure = self.given[name]
        return Entry(f"{figure.source}, {detail}", figure.spread if figure.spread is not None else spread)

    def scaled(self, name: str) -> tuple[float, Entry]:
        """A figure of the sheet, or what the catalogue's gears of the size have."""
        law, value = typical.law(name, self.nominal), self.value(name)
        words = name.replace("_", " ") if len(name) > 2 else name.upper()
        if value is not None:
            of_units = None if name == "wave_generator_inertia" else self.spread
            return value, self.entry(name, f"{words} = {self.given[name].value:g} {self.given[name].unit}", of_units)
        off = hypot(law.scatter, law.exponent * self.size_spread, self.spread)
        how = f"assumed: {words} of the catalogue's gears ~ size^{law.exponent:g}, {self.sized}"
        return law.at(self.size), Entry(how, spread=float(f"{off:.2g}"))

    def gear(self) -> tuple[Gear, dict[str, Entry], list[str]]:
        """The gear, where its numbers come from, and what contradicts itself."""
        (k1, of_k1), (k2, of_k2), (k3, of_k3), (t1, of_t1), (t2, of_t2), (inertia, of_inertia) = (
            self.scaled(name) for name in ("k1", "k2", "k3", "t1", "t2", "wave_generator_inertia")
        )
        if not t1 < t2:
            wrong = "give both" if {"t1", "t2"} - self.given.keys() else "they are interchanged, or one is misread"
            raise ValueError(f"t1 = {t1:.4g} N.m must lie below t2 = {t2:.4g} N.m; {wrong}")
        loss, of_loss = self._loss()
        notes = _wide(0.5 * loss, t1 / k1)
        whole = typical.Divided.of(k1, t1, t2, loss)
        accuracy, of_accuracy = self._accuracy()
        dry, viscous, friction_sources, friction_notes = self._friction()
        mesh, of_mesh, more = self._mesh(dry[1], viscous)
        split = f"k1 x {0.5 * loss / typical.RAD_PER_ARCMIN:.3g} arcmin / 6 each: loop half as wide at zero torque as {of_loss}"
        gear = Gear(
            kinematics=self.kinematics,
            stiffness=stiffness.ThreeSegment(k1=whole.k1, k2=k2, k3=k3, t1=whole.t1, t2=whole.t2),
            hysteresis=hysteresis.MaxwellSlip(stiffness=list(whole.stiffness), breakaway=list(whole.breakaway)),
            kinematic_error=kinematic_error.Fourier(order=[2.0], amplitude=[0.25 * accuracy], phase=[0.0]),
            damping=typical.damping(k1, self.nominal, inertia),
            input_inertia=inertia,
            friction_input=friction.Coulomb(coulomb=dry[0], breakaway=dry[1], viscous=viscous),
            **({} if mesh is None else {"friction_mesh": mesh}),
        )
        sources = {
            "gear.kinematics": Entry(f"{self.source}, ratio {self.nominal:g}: z_f = 2 x ratio, z_c = z_f + 2"),
            "gear.stiffness.k1": _detailed(
                of_k1, "the spring's part K1 (1 - F/T1), with F the sum of the hysteresis breakaways"
            ),
            "gear.stiffness.k2": of_k2,
            "gear.stiffness.k3": of_k3,
            "gear.stiffness.t1": _detailed(of_t1, "the spring's part T1 - F"),
            "gear.stiffness.t2": _detailed(of_t2, "the spring's part T2 - F"),
            "gear.hysteresis.stiffness": Entry("assumed: 2/3, 1/3 and 1/6 of k1, so that all elements slip well below T1"),
            "gear.hysteresis.breakaway": Entry(f"assumed: {split}"),
            "gear.kinematic_error.order": Entry("assumed: the two lobes of the wave generator; no spectrum is given"),
            "gear.kinematic_error.amplitude": Entry(
                f"assumed: peak to peak half the bound on transmission accuracy, {of_accuracy}"
            ),
            "gear.kinematic_error.phase": Entry("assumed: the wave generator angle counts from a zero of the error"),
            "gear.damping": Entry("assumed: 2 % of critical for the wave generator swinging against a held output"),
            "gear.input_inertia": of_inertia,
            **friction_sources,
            **of_mesh,
        }
        return gear, sources, [*notes, *friction_notes, *more]

    def _loss(self) -> tuple[float, str]:
        for name, words in (
            ("hysteresis_loss", "hysteresis loss"),
            ("lost_motion", "lost motion, taken for the hysteresis loss"),
        ):
            value = self.value(name)
            if value is not None:
                figure = self.given[name]
                return value, f"the {words} of {figure.value:g} {figure.unit} ({figure.source})"
        bound = typical.hysteresis_loss(self.nominal)
        return bound, f"the usual bound on hysteresis loss, {bound / typical.RAD_PER_ARCMIN:g} arcmin"

    def _accuracy(self) -> tuple[float, str]:
        value = self.value("transmission_accuracy")
        if value is not None:
            figure = self.given["transmission_accuracy"]
            return value, f"{figure.value:g} {figure.unit} ({figure.source})"
        bound = typical.transmission_accuracy(self.size, self.nominal)
        return bound, f"of the catalogue's gears {bound / typical.RAD_PER_ARCMIN:g} arcmin, {self.sized}"

    def _friction(self) -> tuple[tuple[float, float], float, dict[str, Entry], list[str]]:
        """Coulomb and breakaway torque, the viscous one, where they come from, and what contradicts itself."""
        start, of_start, notes = self._starting()
        running, speed = self.value("no_load_running_torque"), self.value("no_load_running_speed")
        if (running is None) != (speed is None):
            raise ValueError(
                "no_load_running_torque and no_load_running_speed belong together: a running torque determines the viscous "
                "friction only at a known speed; give both or none"
            )
        of_level = Entry("assumed: equal to breakaway; no figure separates the two")
        place = "gear.friction_input."
        if running is None or speed is None:
            off = hypot(typical.VISCOUS_SPREAD, 3.0 * self.size_spread)
            how = f"assumed: ~ size^3 through the no-load running torque of CPL-20-160 at 3500 rpm, 20 degC; {self.sized}"
            viscous, of_viscous, coulomb = typical.viscous(self.size), Entry(how, spread=float(f"{off:.2g}")), start
        elif running > start:
            viscous, coulomb = (running - start) / speed, start
            of_viscous = self.entry("no_load_running_torque", "no-load running torque less breakaway, over its speed")
        else:
            viscous, coulomb = 0.0, running
            of_viscous = Entry(
                "assumed: none; the running torque is not above the breakaway torque, so no part grows with speed"
            )
            of_level = self.entry("no_load_running_torque", "no-load running torque, which is not above the breakaway torque")
        entries = {place + "breakaway": of_start, place + "coulomb": of_level, place + "viscous": of_viscous}
        return (coulomb, start), viscous, entries, notes

    def _starting(self) -> tuple[float, Entry, list[str]]:
        start, back, notes = self.value("starting_torque"), self.value("backdriving_torque"), []
        over = abs(float(self.kinematics.ratio))
        if start is not None:
            if back is not None and not 0.5 < back / (over * start) < 2.0:
                notes.append(
                    f"The starting torque of {start:.4g} N.m times the ratio is {over * start:.4g} N.m, the backdriving torque "
                    f"{back:.4g} N.m; the starting torque is in the model."
                )
            return start, self.entry("starting_torque", "starting torque"), notes
        if back is not None:
            return (
                back / over,
                self.entry("backdriving_torque", "backdriving torque over the ratio: friction is at the input"),
                notes,
            )
        off = hypot(typical.STARTING_SPREAD, 3.0 * self.size_spread)
        how = (
            f"assumed: starting torque ~ size^3 / ratio through the catalogue figures of CSF-17-100 and CSF-25-50; {self.sized}"
        )
        return typical.starting_torque(self.size, self.nominal), Entry(how, spread=float(f"{off:.2g}")), notes

    def _mesh(self, dry: float, viscous: float) -> tuple[Any, dict[str, Entry], list[str]]:
        """Friction that grows with the load: what an efficiency loses beyond the friction without load.

        With T at the output and i the ratio, 1/eta = 1 + mu + i F/T, where F is the friction at the input.
        """
        efficiency, speed = self.value("efficiency"), self.value("efficiency_speed")
        if efficiency is None:
            return None, {}, []
        torque = self.value("efficiency_torque") or self.value("rated_torque")
        if torque is None or speed is None:
            raise ValueError(
                "efficiency needs efficiency_speed, and efficiency_torque or rated_torque: it depends on both; give them, or "
                "leave it out"
            )
        if efficiency > 1.0:
            raise ValueError(f"efficiency = {efficiency:g} must lie in (0, 1]; a percentage is written as a share, as 0.8")
        unloaded = abs(float(self.kinematics.ratio)) * (dry + viscous * speed) / torque
        ratio = 1.0 / efficiency - 1.0 - unloaded
        if ratio < 0.0:
            own = 1.0 / (1.0 + unloaded)
            return (
                None,
                {},
                [f"The friction without load alone makes the efficiency {own:.3g}, the sheet has {efficiency:.3g}."],
            )
        names = ("driving_forward", "driving_reverse", "backdriving_forward", "backdriving_reverse")
        detail = f"efficiency {efficiency:g}: what is lost beyond the friction without load"
        entries = {
            f"gear.friction_mesh.{each}": self.entry("efficiency", detail)
            if each.startswith("driving")
            else Entry("assumed: as when driving")
            for each in names
        }
        return friction.LoadDependent(**dict.fromkeys(names, ratio)), entries, []


def _wide(width: float, twist: float) -> list[str]:
    """Return remarks on a loop of this width at the first loading up to T1, at this twist [rad]."""
    wide, turned = width / typical.RAD_PER_ARCMIN, twist / typical.RAD_PER_ARCMIN
    if 0.5 * width >= twist:
        raise ValueError(
            f"hysteresis_loss: half of it, {wide:.3g} arcmin, is wider than what the gear twists between -T1 and "
            f"T1, {2.0 * turned:.3g} arcmin; give k1 and t1 of this gear, or write a gear file with backlash"
        )
    if width <= twist:
        return []
    return [
        f"The loop is {wide:.3g} arcmin wide, more than the {turned:.3g} arcmin of twist at T1: "
        "a gear that is loaded for the first time is stiffer than K1."
    ]


def _detailed(entry: Entry, detail: str) -> Entry:
    return replace(entry, source=f"{entry.source}; {detail}")


def _kinematics(ratio: float, fixed: str | None) -> Any:
    """Teeth of a gear of two lobes."""
    nominal = arguments.number("ratio", ratio)
    if fixed is not None:
        arguments.one_of("fixed", fixed, ("circular_spline", "flexspline"))
    if fixed is None:
        if nominal > 0.0:
            raise ValueError(
                f'ratio = {nominal:g} leaves the fixed part open; give ratio = {-nominal:g}, or fixed = "circular_spline" '
                '(the output turns against the input) or "flexspline" (it turns with it)'
            )
        fixed = "circular_spline"
    elif nominal < 0.0 and fixed != "circular_spline":
        raise ValueError(f"ratio = {nominal:g}: with the flexspline held the output turns with the input; give it without sign")
    teeth = 2.0 * abs(nominal)
    if not 4 <= teeth < 100_000 or teeth != round(teeth):
        raise ValueError(
            f"ratio = {nominal:g}: a gear of two lobes has 2 x ratio teeth on its flexspline, a whole number of 4 or more; for "
            "another one write a gear file"
        )
    return kinematics.StrainWave(flexspline_teeth=int(teeth), circular_spline_teeth=int(teeth) + 2, fixed=fixed)
