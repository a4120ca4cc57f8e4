//! The method of a solve: options inside the method's message replace the options beside `start`.

use crate::error::ProtocolError;
use crate::v1::options::Method;
use crate::v1::{self, StartKind};

/// Options without a method that is a start: its name, if there was one, and what it says in the fields of clients
/// that know no methods.
pub(super) fn unfolded(
    mut m: v1::Options,
) -> Result<(v1::Options, Option<&'static str>), ProtocolError> {
    let method = match m.method.take() {
        None => return Ok((m, None)),
        Some(method @ (Method::Decompose(_) | Method::Question(_))) => {
            m.method = Some(method);
            return Ok((m, None));
        }
        Some(method) => method,
    };
    if let Some((field, _)) = beside(&m).into_iter().find(|(_, given)| *given) {
        let expected = "nothing beside the method, which has this option itself";
        return Err(ProtocolError::invalid(field, "given", expected));
    }
    let (name, start) = match method {
        Method::Automatic(v1::AutomaticStart {}) => ("automatic", StartKind::Auto),
        Method::TotalDegree(v1::TotalDegreeStart {}) => ("total_degree", StartKind::TotalDegree),
        Method::Multihomogeneous(v1::MultihomogeneousStart {}) => {
            ("multihomogeneous", StartKind::Multihomogeneous)
        }
        Method::Polyhedral(v1::PolyhedralStart {}) => ("polyhedral", StartKind::Polyhedral),
        Method::Regeneration(v1::RegenerationStart {}) => ("regeneration", StartKind::Regeneration),
        Method::LinearProduct(v1::LinearProductStart { sets }) => {
            m.sets = sets;
            ("linear_product", StartKind::LinearProduct)
        }
        Method::Given(v1::GivenStart {
            start_solutions,
            start_parameters,
        }) => {
            m.start_solutions = start_solutions;
            m.start_parameters = start_parameters;
            ("given", StartKind::Given)
        }
        Method::Monodromy(v1::MonodromyStart {
            start_solutions,
            start_parameters,
            idle_loops,
            expected_solutions,
            trace_test,
            confidence,
        }) => {
            m.start_solutions = start_solutions;
            m.start_parameters = start_parameters;
            m.idle_loops = idle_loops;
            m.expected_solutions = expected_solutions;
            m.trace_test = trace_test;
            m.confidence = confidence;
            ("monodromy", StartKind::Monodromy)
        }
        Method::Decompose(_) | Method::Question(_) => unreachable!("these were kept above"),
    };
    m.start = start.into();
    Ok((m, Some(name)))
}

/// The options of single starts, and whether each is given.
fn beside(m: &v1::Options) -> [(&'static str, bool); 8] {
    [
        ("start", m.start != i32::from(StartKind::Unspecified)),
        ("start_parameters", !m.start_parameters.is_empty()),
        ("start_solutions", m.start_solutions.is_some()),
        ("idle_loops", m.idle_loops.is_some()),
        ("expected_solutions", m.expected_solutions.is_some()),
        ("sets", !m.sets.is_empty()),
        ("trace_test", m.trace_test),
        ("confidence", m.confidence.is_some()),
    ]
}

/// An error in the place where the client wrote the option.
pub(super) fn placed(error: ProtocolError, method: Option<&'static str>) -> ProtocolError {
    let first = error.field().split(['.', '[']).next().unwrap_or_default();
    let of_method = beside(&v1::Options::default())
        .iter()
        .any(|(field, _)| *field == first);
    match method {
        Some(name) if of_method => error.within(name),
        _ => error,
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::options;
    use crate::submission;
    use crate::v1::options::Method;
    use crate::v1::{self, StartKind};
    use prost::Message;

    fn points() -> v1::StartSolutions {
        v1::StartSolutions {
            source: Some(v1::start_solutions::Source::Points(v1::Points {
                dimension: 1,
                coordinates: vec![1.0, 0.0],
            })),
        }
    }

    #[test]
    fn a_method_says_what_was_said_beside_start() {
        let one = v1::Complex { re: 1.0, im: 0.0 };
        let loops = v1::MonodromyStart {
            start_solutions: Some(points()),
            start_parameters: vec![one],
            idle_loops: Some(7),
            expected_solutions: Some(40),
            trace_test: true,
            confidence: None,
        };
        let with = v1::Options {
            certify: true,
            method: Some(Method::Monodromy(loops.clone())),
            ..v1::Options::default()
        };
        let beside = v1::Options {
            certify: true,
            start: StartKind::Monodromy.into(),
            start_solutions: loops.start_solutions.clone(),
            start_parameters: loops.start_parameters.clone(),
            idle_loops: loops.idle_loops,
            expected_solutions: loops.expected_solutions,
            trace_test: true,
            ..v1::Options::default()
        };
        let read = v1::Options::decode(with.encode_to_vec().as_slice()).expect("a message");
        assert_eq!(options(read), options(beside));
        let starts = [
            (
                Method::Automatic(v1::AutomaticStart {}),
                submission::StartKind::Auto,
            ),
            (
                Method::TotalDegree(v1::TotalDegreeStart {}),
                submission::StartKind::TotalDegree,
            ),
            (
                Method::Multihomogeneous(v1::MultihomogeneousStart {}),
                submission::StartKind::Multihomogeneous,
            ),
            (
                Method::Polyhedral(v1::PolyhedralStart {}),
                submission::StartKind::Polyhedral,
            ),
            (
                Method::Regeneration(v1::RegenerationStart {}),
                submission::StartKind::Regeneration,
            ),
            (
                Method::LinearProduct(v1::LinearProductStart::default()),
                submission::StartKind::LinearProduct,
            ),
            (
                Method::Given(v1::GivenStart::default()),
                submission::StartKind::Given,
            ),
        ];
        for (method, start) in starts {
            let read = options(v1::Options {
                method: Some(method),
                ..v1::Options::default()
            });
            assert_eq!(read.map(|options| options.start), Ok(start));
        }
    }

    #[test]
    fn an_option_stands_in_one_place_and_is_named_there() {
        let method = Method::Monodromy(v1::MonodromyStart {
            confidence: Some(2.0),
            ..v1::MonodromyStart::default()
        });
        let with = v1::Options {
            method: Some(method),
            ..v1::Options::default()
        };
        let said = |m: v1::Options| options(m).expect_err("this is no choice").to_string();
        assert_eq!(
            said(with.clone()),
            "monodromy.confidence is 2; expected a probability between 0 and 1, both excluded"
        );
        let twice = said(v1::Options {
            idle_loops: Some(3),
            ..with
        });
        assert!(
            twice.starts_with("idle_loops is given; expected nothing beside"),
            "{twice}"
        );
    }
}
