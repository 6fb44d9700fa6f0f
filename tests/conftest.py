from hypothesis import settings

pytest_plugins = ["hal.conformance.plugin"]

# A busy machine is no failure, and CI tries the same examples every time.
settings.register_profile("house", deadline=None, derandomize=True)
settings.load_profile("house")
