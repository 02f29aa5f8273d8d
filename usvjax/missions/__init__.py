"""Missions: a folder each, with its parameters, scenes, run, figures and what a study needs."""
