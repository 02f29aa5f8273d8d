"""Comparisons of usvjax with what people use today, run side by side, and their results."""
