!> Recorded ground accelerations: PEER's AT2 format, or tables below a line of names.
!>
!> Unit, interval and number of the samples are those that the file states; keys that contradict it
!> are refused. Sample 1 of one-column and AT2 records is at t = 0.
module rwmf_input_record_record_reader
   use rwmf_core_error, only: add_context, err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_record_at2, only: has_at2_header, read_at2, read_at2_header
   use rwmf_input_record_columns, only: fill_channels, read_table, read_table_header, table_t
   use rwmf_input_record_formats, only: check_format
   use rwmf_input_record_samples, only: samples_t
   use rwmf_input_record_statements, only: is_same_interval, stated_t
   use rwmf_problem_record, only: record_t, set_factor
   use rwmf_text_crc32, only: crc32
   use rwmf_text_file, only: read_file
   use rwmf_text_strings, only: integer_to_text, real_to_text, shown
   implicit none
   private

   public :: read_record, parse_record, make_record, complete_samples
   public :: read_samples, read_facts

contains

   !> Read a record from a file.
   !>
   !> Errors: those of `read_file` and `parse_record`.
   subroutine read_record(path, dt, unit, scale, g, record, error)
      character(*), intent(in) :: path
      !! path of the file
      real(wp), intent(in), optional :: dt
      !! sampling interval of a one-column record [s]; must be absent for the other formats
      character(*), intent(in), optional :: unit
      !! 'g', 'm/s2' or 'cm/s2'; required unless the file states it, must be absent for AT2
      real(wp), intent(in) :: scale
      !! factor on the accelerations [-]
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      type(record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: bytes

      call read_file(path, bytes, error)
      if (.not. allocated(error)) then
         call parse_record(bytes, dt, unit, scale, g, record, error)
      end if
   end subroutine read_record

   !> Read a record from the text of its file.
   !>
   !> Errors: those of `read_samples` and `make_record`, several columns of accelerations.
   subroutine parse_record(bytes, dt, unit, scale, g, record, error)
      character(*), intent(in) :: bytes
      !! the whole file, lines with their line feeds
      real(wp), intent(in), optional :: dt
      !! as in `read_record` [s]
      character(*), intent(in), optional :: unit
      !! as in `read_record`
      real(wp), intent(in) :: scale
      !! factor on the accelerations [-]
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      type(record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      type(samples_t), allocatable :: channels(:)

      call read_samples(bytes, channels, error)
      if (allocated(error)) return
      if (size(channels) > 1) then
         call fail(error, err_input, 'the file has '//trim(integer_to_text(size(channels))) &
            //" columns of accelerations: 'rwmf records convert --channel' writes one of them")
         return
      end if
      call make_record(channels(1), dt, unit, scale, g, record, error)
   end subroutine parse_record

   !> Read the samples of a file. This is the only reader of AT2 files and tables.
   !>
   !> Errors: another format, an invalid line, another quantity than accelerations, statements of
   !> the file that contradict each other or the samples.
   subroutine read_samples(bytes, channels, error)
      character(*), intent(in) :: bytes
      !! the whole file, lines with their line feeds
      type(samples_t), allocatable, intent(out) :: channels(:)
      !! (n) one for each column of accelerations
      type(error_t), allocatable, intent(out) :: error
      type(table_t) :: table
      integer :: first
      integer :: last

      call check_format(bytes, error)
      if (allocated(error)) return
      call find_text(bytes, first, last)
      associate (text => bytes(first:last))
         if (has_at2_header(text)) then
            allocate (channels(1))
            call read_at2(text, channels(1), error)
         else
            call read_table_header(text, table, error)
            if (.not. allocated(error)) call read_table(text, table, error)
            if (.not. allocated(error)) call fill_channels(table, channels)
         end if
      end associate
      if (allocated(error)) return
      channels%crc32 = crc32(bytes)
   end subroutine read_samples

   !> Read the header of a file: its format, unit and number of channels.
   subroutine read_facts(bytes, is_at2, unit, n_channels, error)
      character(*), intent(in) :: bytes
      !! the whole file
      logical, intent(out) :: is_at2
      !! true for AT2, false for a table
      character(:), allocatable, intent(out) :: unit
      !! 'g', 'm/s2' or 'cm/s2'; '' if the file gives none
      integer, intent(out) :: n_channels
      !! columns of accelerations
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for another format or an invalid header
      type(stated_t) :: stated
      type(table_t) :: table
      integer :: first
      integer :: last
      integer :: line
      integer :: position

      unit = ''
      n_channels = 1
      is_at2 = .false.
      call check_format(bytes, error)
      if (allocated(error)) return
      call find_text(bytes, first, last)
      is_at2 = has_at2_header(bytes(first:last))
      if (is_at2) then
         call read_at2_header(bytes(first:last), stated, position, line, error)
      else
         call read_table_header(bytes(first:last), table, error)
         stated = table%stated
         if (.not. allocated(error)) n_channels = size(table%accelerations)
      end if
      if (allocated(error) .or. .not. allocated(stated%unit)) return
      unit = trim(stated%unit%base)
   end subroutine read_facts

   !> Find the text of a file, between the byte order mark of UTF-8 and the end of file of DOS.
   pure subroutine find_text(bytes, first, last)
      character(*), intent(in) :: bytes
      integer, intent(out) :: first
      integer, intent(out) :: last
      character(*), parameter :: mark = char(239)//char(187)//char(191)
      character(*), parameter :: end_of_file = achar(26)
      integer :: at

      first = 1
      if (index(bytes, mark) == 1) first = len(mark) + 1
      last = verify(bytes, ' '//achar(9)//achar(10)//achar(13)//end_of_file, back=.true.)
      at = index(bytes(last + 1:), end_of_file)
      last = merge(len(bytes), last + at - 1, at == 0)
   end subroutine find_text

   !> Make a record from its samples.
   !>
   !> Errors: fewer than two samples, `dt` or `unit` missing or not allowed, overflow.
   subroutine make_record(samples, dt, unit, scale, g, record, error)
      type(samples_t), intent(in) :: samples
      real(wp), intent(in), optional :: dt
      !! interval of samples that have neither times nor an interval [s]
      character(*), intent(in), optional :: unit
      !! as in `read_record`
      real(wp), intent(in) :: scale
      !! factor on the accelerations [-]
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      type(record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      integer :: at

      if (samples%format == 'AT2' .and. present(dt)) then
         call fail(error, err_input, 'the record (AT2) has its own times: dt must not be given')
      else if (samples%format == 'AT2' .and. present(unit)) then
         call fail(error, err_input, 'the record (AT2) is in '//trim(said_unit(samples)) &
            //': unit must not be given')
      else
         call check_interval(samples, dt, error)
      end if
      if (.not. allocated(error)) call check_unit(samples, unit, error)
      if (allocated(error)) return
      record%format = samples%format
      record%crc32 = samples%crc32
      record%unit = trim(unit_of_samples(samples, unit))
      if (present(dt)) then
         record%dt = dt
      else if (allocated(samples%dt)) then
         record%dt = real(samples%dt, wp)
      end if
      call set_times(record, size(samples%a), samples%t)
      ! set the accelerations and their largest magnitude
      record%a = real(samples%a, wp)
      at = maxloc(abs(record%a), dim=1)
      record%largest = abs(record%a(at))
      record%t_peak = record%t(at)
      call set_factor(record, scale, g, error)
   end subroutine make_record

   !> Complete samples by keys, which must agree with the statements of their file.
   !>
   !> Errors: fewer than two samples, `dt` or `unit` missing or contradicted.
   subroutine complete_samples(samples, dt, unit, error)
      type(samples_t), intent(inout) :: samples
      real(dp), intent(in), optional :: dt
      !! interval of one column [s]
      character(*), intent(in), optional :: unit
      !! 'g', 'm/s2' or 'cm/s2'
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: step

      if (present(dt)) step = real(dt, wp)
      call check_interval(samples, step, error)
      if (.not. allocated(error)) call check_unit(samples, unit, error)
      if (allocated(error)) return
      samples%unit = trim(unit_of_samples(samples, unit))
      if (present(dt) .and. samples%format /= 'AT2') samples%dt = dt
   end subroutine complete_samples

   !> Unit of the samples: that of the file, or else the key's.
   pure function unit_of_samples(samples, unit) result(own)
      type(samples_t), intent(in) :: samples
      character(*), intent(in), optional :: unit
      character(5) :: own

      if (allocated(samples%unit)) then
         own = samples%unit
      else
         own = unit
      end if
   end function unit_of_samples

   !> Check that the interval comes from the samples or from the key, or that both agree.
   subroutine check_interval(samples, dt, error)
      type(samples_t), intent(in) :: samples
      real(wp), intent(in), optional :: dt
      !! [s]
      type(error_t), allocatable, intent(out) :: error

      if (size(samples%a) < 2) then
         call fail(error, err_input, 'a record needs at least 2 samples')
      else if (.not. present(dt)) then
         if (allocated(samples%t) .or. allocated(samples%dt)) return
         call fail(error, err_input, 'the record has one column: it needs the key dt [s]')
      else if (allocated(samples%t)) then
         call fail(error, err_input, 'the record ('//samples%format//') has its own times: dt ' &
            //'must not be given')
      else if (allocated(samples%dt)) then
         if (is_same_interval(real(dt, dp), samples%dt)) return
         call fail(error, err_input, 'dt = '//trim(real_to_text(dt))//' s: the file says ' &
            //trim(real_to_text(real(samples%dt, wp)))//' s')
         if (samples%dt_line > 0) call add_context(error, 'line ' &
            //trim(integer_to_text(samples%dt_line)))
      end if
   end subroutine check_interval

   !> Check that the unit comes from the samples or from the key, or that both agree.
   subroutine check_unit(samples, unit, error)
      type(samples_t), intent(in) :: samples
      character(*), intent(in), optional :: unit
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: which

      if (.not. allocated(samples%unit)) then
         if (present(unit)) return
         which = 'the record ('//samples%format//')'
         if (samples%format == 'table') which = "the column '"//shown(samples%name)//"'"
         call fail(error, err_input, which//" needs the key unit: 'g', 'm/s2' or 'cm/s2'")
      else if (present(unit)) then
         if (.not. samples%is_converted .and. unit == samples%unit) return
         call fail(error, err_input, "unit = '"//unit//"': the header says '" &
            //trim(said_unit(samples))//"'")
         if (samples%unit_line > 0) call add_context(error, 'line ' &
            //trim(integer_to_text(samples%unit_line)))
      end if
   end subroutine check_unit

   !> Unit of the samples as their file has it.
   pure function said_unit(samples) result(text)
      type(samples_t), intent(in) :: samples
      character(80) :: text

      text = samples%unit
      if (samples%is_converted) text = shown(samples%unit_text)
   end function said_unit

   !> Set the times of the samples, and their interval if it is uniform.
   subroutine set_times(record, n, t)
      type(record_t), intent(inout) :: record
      !! record; its `dt` is already set for formats without times
      integer, intent(in) :: n
      real(dp), allocatable, intent(in) :: t(:)
      !! (n) [s], allocated if the file has times
      real(wp), parameter :: printed_digits = 1e-4_wp
      !! rounding of printed times that is accepted as uniform, over dt [-]
      real(wp) :: dt
      integer :: i

      record%n = n
      allocate (record%t(n))
      if (.not. allocated(t)) then
         record%t(:) = [(real(i - 1, wp)*record%dt, i=1, n)]
         record%t_last = record%t(n)
         return
      end if
      record%t(:) = real(t, wp)
      record%t_last = record%t(n)
      dt = (record%t(n) - record%t(1))/real(n - 1, wp)
      do i = 1, n
         if (abs(record%t(i) - record%t(1) - real(i - 1, wp)*dt) > printed_digits*dt) return
      end do
      record%dt = dt
   end subroutine set_times

end module rwmf_input_record_record_reader
