"""What holds for all tests."""

from hypothesis import settings

# How long an example takes says more about the machine than about the example. The examples are the same on each run, so that a
# failure tells of the change and not of the draw; `--hypothesis-profile=explore` draws others.
settings.register_profile("strainwave", deadline=None, derandomize=True)
settings.register_profile("explore", deadline=None, derandomize=False)
settings.load_profile("strainwave")
