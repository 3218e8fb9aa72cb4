"""One scenario in the browser: what the planners did, what they believed, and what came."""
