"""The hard cases: scenes on which cable programs fail, and the five rules by which every run of them is judged."""
