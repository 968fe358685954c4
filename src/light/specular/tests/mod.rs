//! Tests of the connections, against rays that are traced without them.

mod roots;
mod traced_ray;
mod tracing;
