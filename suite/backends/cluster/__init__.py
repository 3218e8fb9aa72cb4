"""Trials on the workers of a Dask cluster.

The head (``head``) hands out chunks of trials (``chunks``), with the planners' files (``shipping``); on its node each
is worked off by a crew of one local worker process (``node``), so that a planner that hangs or crashes costs one trial.
"""
