"""From the folder of a test, or from columns of angle and torque, to loops."""
