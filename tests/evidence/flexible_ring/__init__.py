"""A strain wave gear as a flexible ring by finite elements, by numpy alone: tables, modes and records with known truth.

Shares nothing with the package: no law, no formula, no function. Modules: `ring` (elements and eigenmodes), `gear` (a drawn
gear with its contacts), `tables` (what an engineer brings from finite elements), `motion` (time integration), `truth`
(eigenlines in the frame of the lobes), `files` (what he writes).
"""
