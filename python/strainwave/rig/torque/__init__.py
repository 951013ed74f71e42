"""From masses on pans to torque on the shaft, and how well it is known."""
