//! Methods of the services, each named once: who may call it, and that it is counted by its name.

/// A client's method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClientMethod {
    /// The name of the method, as `proto/client_api.proto` declares it.
    pub name: &'static str,
    /// Whether it changes nothing: viewers may call it.
    pub reads_only: bool,
}

const fn reads(name: &'static str) -> ClientMethod {
    ClientMethod {
        name,
        reads_only: true,
    }
}

const fn changes(name: &'static str) -> ClientMethod {
    ClientMethod {
        name,
        reads_only: false,
    }
}

/// The methods of `cognate.v1.ClientApi`.
pub const OF_CLIENTS: [ClientMethod; 13] = [
    changes("Submit"),
    reads("Watch"),
    reads("GetSummary"),
    reads("GetDecomposition"),
    reads("StreamSolutions"),
    reads("StreamPaths"),
    reads("Explain"),
    changes("Cancel"),
    changes("Delete"),
    reads("ListJobs"),
    reads("ListWorkers"),
    changes("Upload"),
    reads("GetServerInfo"),
];

/// The methods of `cognate.v1.WorkerApi`.
pub const OF_WORKERS: [&str; 8] = [
    "Pull",
    "Renew",
    "Report",
    "GiveBack",
    "GetProblem",
    "GetStage",
    "GetObject",
    "GetSharedMemory",
];

/// Whether a client's method of this name changes nothing; one that is not known may change anything.
pub fn reads_only(name: &str) -> bool {
    let mut methods = OF_CLIENTS.iter();
    methods.any(|method| method.name == name && method.reads_only)
}

/// The name of the method that a path calls, where it is one of these.
pub fn called(path: &str) -> Option<&'static str> {
    let (service, name) = path.strip_prefix("/cognate.v1.")?.split_once('/')?;
    match service {
        "ClientApi" => OF_CLIENTS
            .iter()
            .map(|method| method.name)
            .find(|method_name| *method_name == name),
        "WorkerApi" => OF_WORKERS
            .into_iter()
            .find(|method_name| *method_name == name),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_protocol::DESCRIPTORS;
    use prost::Message;
    use prost_types::FileDescriptorSet;

    /// The methods that `proto/` declares for a service.
    fn methods_of(service: &str) -> Vec<String> {
        let files = FileDescriptorSet::decode(DESCRIPTORS).expect("descriptors");
        let services = files.file.into_iter().flat_map(|file| file.service);
        let descriptors = services.filter(|descriptor| descriptor.name() == service);
        let methods = descriptors.flat_map(|descriptor| descriptor.method);
        methods.map(|method| method.name().to_owned()).collect()
    }

    #[test]
    fn every_method_of_the_services_is_named_once() {
        let of_clients = OF_CLIENTS.map(|method| method.name);
        assert_eq!(methods_of("ClientApi"), of_clients);
        assert_eq!(methods_of("WorkerApi"), OF_WORKERS);
    }

    #[test]
    fn a_path_calls_the_method_of_its_service() {
        assert_eq!(called("/cognate.v1.ClientApi/Submit"), Some("Submit"));
        assert_eq!(called("/cognate.v1.WorkerApi/Pull"), Some("Pull"));
        for path in [
            "/",
            "/cognate.v1.WorkerApi/Submit",
            "/cognate.v1.WorkerApi/Pull/x",
            "/cognate.v1.ClientApi/Any",
            "/grpc.health.v1.Health/Check",
            "/a/Pull",
        ] {
            assert_eq!(called(path), None, "{path}");
        }
        assert!(reads_only("Watch") && !reads_only("Submit") && !reads_only("Any"));
    }
}
