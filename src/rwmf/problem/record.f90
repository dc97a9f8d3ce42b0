!> Recorded ground acceleration with its source and its samples.
module rwmf_problem_record
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_problem_group_values, only: get_real, get_text, group_values_t, real_of
   implicit none
   private

   public :: record_t, record_source_t, fill_source, set_factor
   public :: horizontal_group, upward_group, sets_motion, read_once

   character(*), parameter :: horizontal_group = 'motion'
   !! group of the horizontal ground motion
   character(*), parameter :: upward_group = 'vertical'
   !! group of the vertical ground motion
   character(*), parameter :: read_once = 'its record is read there'
   !! reason why the interval of a record cannot change after it has been read

   !> Source of a record.
   type :: record_source_t
      character(:), allocatable :: file
      !! path of the record as given in the case
      character(:), allocatable :: path
      !! path of the record resolved against the folder of the namelist
      real(wp), allocatable :: dt
      !! sampling interval of a one-column record [s]
      character(:), allocatable :: unit
      !! 'g', 'm/s2' or 'cm/s2'; absent if the file states it
      real(wp) :: scale
      !! factor on the record [-]
   end type record_source_t

   !> Record that has been read and checked. A changed case has all components except the samples,
   !> which stay in the original case.
   type :: record_t
      real(wp), allocatable :: t(:)
      !! (n) strictly increasing times [s]
      real(wp), allocatable :: a(:)
      !! (n) ground acceleration [`unit`]; `factor` times it is the motion
      character(:), allocatable :: unit
      !! 'g', 'm/s2' or 'cm/s2'
      real(wp) :: factor = 1
      !! m/s2 per `unit`, including `scale`
      integer :: n
      !! number of samples, at least 2
      real(wp), allocatable :: dt
      !! sampling interval [s]; absent if it is not uniform
      real(wp) :: t_last
      !! time of the last sample [s]
      real(wp) :: largest
      !! largest magnitude of `a` [`unit`]
      real(wp) :: peak
      !! largest magnitude of the acceleration [m/s2]
      real(wp) :: t_peak
      !! first time of that acceleration [s]
      character(:), allocatable :: format
      !! 'one column', 'two columns', 'table', 'AT2' or 'array'
      character(8) :: crc32
      !! checksum of the bytes of the file, or of the samples of an array, hexadecimal
   end type record_t

contains

   !> True if a group describes the ground motion.
   elemental logical function sets_motion(group)
      character(*), intent(in) :: group
      !! name of the group, without &

      sets_motion = group == horizontal_group .or. group == upward_group
   end function sets_motion

   !> Set the source of a record from a group of the case.
   subroutine fill_source(values, group, source)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      class(record_source_t), intent(inout) :: source

      source%scale = real_of(values, group, 'scale')
      call get_real(values, group, 'dt', source%dt)
      call get_text(values, group, 'file', source%file)
      call get_text(values, group, 'unit', source%unit)
   end subroutine fill_source

   !> Set the factor of the samples. Fails with `err_input` if the product overflows.
   pure subroutine set_factor(record, scale, g, error)
      type(record_t), intent(inout) :: record
      !! record with its unit and largest sample
      real(wp), intent(in) :: scale
      !! [-]
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      type(error_t), allocatable, intent(out) :: error

      record%factor = scale*g
      if (record%unit == 'm/s2') record%factor = scale
      if (record%unit == 'cm/s2') record%factor = scale/100
      record%peak = abs(record%factor)*record%largest
      if (record%largest <= huge(1.0_dp)/max(1.0_wp, abs(record%factor))) return
      call fail(error, err_input, 'the accelerations overflow: check unit and scale')
   end subroutine set_factor

end module rwmf_problem_record
