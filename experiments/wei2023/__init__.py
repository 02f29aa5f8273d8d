"""Wei & Zhang 2023: A* with key points, and DWA, for vessels that gather in formation."""
