import hypothesis

# No deadline: the first example of a kernel pays for its compilation.
# Derandomized: the tests do the same in every run.
hypothesis.settings.register_profile("suite", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.load_profile("suite")
