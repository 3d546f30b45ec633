"""Many independent pieces of work, their results on disk, on one machine or on many."""
