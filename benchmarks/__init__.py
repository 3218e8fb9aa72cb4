"""Speed, as ratios against named baselines in one run; ``docs/performance.md`` reads the figures."""
