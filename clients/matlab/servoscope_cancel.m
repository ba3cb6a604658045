function job = servoscope_cancel(job)
%SERVOSCOPE_CANCEL  Cancels a job.
%   J = servoscope_cancel(J) cancels the job J, a struct or an id: at once if
%   it waits, at its next evaluation if it runs.
    path = ['/v1/jobs/' servoscope_job_id(job) '/cancel'];
    job = jsondecode(servoscope_request('POST', path, struct(), 30));
end
