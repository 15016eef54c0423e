//! Elementary functions in lanes.
