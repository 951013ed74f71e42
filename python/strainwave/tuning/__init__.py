"""Controllers of a drive: tuned, compensated by what is known of its gear, and judged on gears that it may be."""
