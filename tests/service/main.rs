//! The service as real processes: a coordinator, workers, clients, and what may happen to each.

mod any_split_same_answer;
mod bad_input;
mod body_guidance;
mod bucket;
mod certificates;
mod coordinator_restarted;
mod decomposition_killed;
mod deletion;
mod digits;
mod full_disk;
mod inspection;
mod late_chunk;
mod lease_expired;
mod mixed_cells;
mod monodromy;
mod nine_points;
mod other_users;
mod postgres;
mod questions_killed;
mod report_repeated;
mod shared_memory;
mod sisters;
mod stranger;
mod submit_to_result;
mod tracking_by_hand;
mod worker_lost;
