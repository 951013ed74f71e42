"""The torsion test rig: images of two markers and masses on pans in, the loop of a gear, its stiffness and lost motion out."""
