//! Tests of the connections, against rays that are traced without them.

mod fresnel;
mod gain;
mod pairs;
mod physics;
mod roots;
mod traced_ray;
mod tracing;
