function measurement = servoscope_upload(source, varargin)
%SERVOSCOPE_UPLOAD  Uploads a measurement.
%   M = servoscope_upload(FILE) uploads a file.
%
%   M = servoscope_upload(COLUMNS) uploads the fields of a struct, vectors of
%   one length, or a table. Their names are those that a file would have:
%     time_s, input, output             a record over time
%     magnitude, frequency_hz, re, im   a harmonic table
%
%   M = servoscope_upload(..., 'Name', VALUE, ...) says what the data do not
%   say, and takes precedence over what a file says:
%     input        name and unit of the input, 'current A'
%     response     kind and unit of the response, 'velocity rad/s',
%                  'position mm' or 'acceleration m/s^2'
%     period_s     period of a record, seconds, or 'none'
%     magnitude    amplitude of the input, for a table without such a column
%   and name, machine, axis, loop, amplitude, and the others of docs/files.md.
%
%   M.id is the id of the measurement, M.notes how the server understood it.
%
%   Errors: servoscope:unreadable_measurement, with file, line and column in
%   the message, where the data cannot be read.
%
%   Example:
%     t = (0:9999)' / 1000;
%     M = servoscope_upload(struct('time_s', t, 'input', i, 'output', v), ...
%         'input', 'current A', 'response', 'velocity rad/s', 'period_s', 2);
    if mod(numel(varargin), 2) ~= 0
        error('servoscope:argument', 'a name has no value');
    end
    path = source;
    if isa(source, 'table')
        source = table2struct(source, 'ToScalar', true);
    end
    if isstruct(source)
        path = [tempname() '.csv'];
        write_columns(path, source);
        cleaner = onCleanup(@() delete(path));
    elseif ~exist(path, 'file')
        error('servoscope:file', 'there is no file %s', path);
    end
    parts = {'file', char(path), true};
    for i = 1:2:numel(varargin)
        value = varargin{i + 1};
        if islogical(value)
            words = {'no', 'yes'};
            value = words{1 + value};
        elseif isnumeric(value)
            value = sprintf('%.17g', value);
        end
        parts(end + 1, :) = {char(varargin{i}), char(value), false};
    end
    text = servoscope_request('POST', '/v1/measurements', struct('parts', {parts}), 120);
    measurement = jsondecode(text);
end

function write_columns(path, columns)
    names = fieldnames(columns);
    values = cellfun(@(name) double(columns.(name)(:)), names, 'UniformOutput', false);
    lengths = cellfun(@numel, values);
    if any(lengths ~= lengths(1))
        error('servoscope:argument', 'the columns have different lengths');
    end
    if ~all(cellfun(@isreal, values))
        error('servoscope:argument', 'a column is complex: give real and imaginary part');
    end
    file = fopen(path, 'w');
    if file < 0
        error('servoscope:file', 'cannot write %s', path);
    end
    fprintf(file, '%s\n', strjoin(names', ','));
    row = [strjoin(repmat({'%.17g'}, 1, numel(names)), ',') '\n'];
    fprintf(file, row, [values{:}]');
    fclose(file);
end
