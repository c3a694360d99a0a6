"""Where the time of a step goes, and how near that is to what the machine can do (see docs/performance.md)."""
