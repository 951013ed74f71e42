"""What holds for all tests."""

from hypothesis import settings

# How long an example takes says more about the machine than about the example.
settings.register_profile("strainwave", deadline=None)
settings.load_profile("strainwave")
