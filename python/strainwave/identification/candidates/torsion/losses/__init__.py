"""Loss of torsion loops by its source: bearing at the input, dry and viscous friction of the gear, mesh, and flexspline.

On both ways of a loop the torque is S(twist) ± h: a curve that both ways share, and half of the width. Each source has its own
form of h, with S the torque on that curve, T its largest, v the rate of the twist and i the ratio:

    bearing, dry                  h = |i| b             at the input alone: with the input locked it does not turn
    bearing, viscous              h = i² c_b |v|        at the input alone
    gear, dry                     h = d                 at both sides, whatever the load is
    gear, viscous                 h = c |v|             at both sides
    mesh, in proportion to load   h = mu |S|            sliding between teeth, Coulomb
    flexspline, material          h = eta T sqrt(1 - (S/T)²), or with 3 pi / 8 (1 - (S/T)²) in place of the root
    flexspline, relaxing material h = k tau |v| / (1 + omega² tau²)

Both shapes of the material lose 2 pi eta times the stored energy in a cycle of a linear spring, at any rate: eta is a loss
factor. The first is the ellipse of a complex stiffness, the second the lens of Rayleigh's law; any mixture is fitted. The
relaxing material is one Maxwell branch (`sw.material.GeneralisedMaxwell`). It loses pi a² k omega tau / (1 + omega² tau²) in a
cycle under a sine of the amplitude a and the angular frequency omega. Viscous friction, a loss factor, k and tau are four
unknowns over the rate: the material takes part from four rates on, if they show it beyond chance. Friction changes with the
temperature by exp(-kappa (temperature - that of the largest loop)); the material does not.

The torque is linear in all but kappa and tau, and so is the loss of a cycle. Loops at one load do not separate what is
proportional to load from what is constant, loops at one rate not viscous from dry friction, and loops at one side not the
bearing from the gear: the covariance of the fit contains that, and a share is stated only as well as it is separated.
"""
